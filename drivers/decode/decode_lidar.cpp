#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/decode/decode_parts.hpp"
#include "drivers/decode/network_capture.hpp"
#include "drivers/decode/settings.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {
namespace {

using nlohmann::ordered_json;

ordered_json scan_json(const LidarScan& given) {
  const Scan& scan = given.scan;
  ordered_json line = {{"type", "scan"},
                       {"t", scan.t},
                       {"angle_min", scan.angle_min},
                       {"angle_increment", scan.angle_increment},
                       {"time_increment", scan.time_increment.value_or(0.0)},
                       {"range_min", scan.range_min},
                       {"range_max", scan.range_max}};
  if (given.device_time) line["device_time"] = *given.device_time;
  if (given.counter) line["counter"] = *given.counter;
  if (given.partial) line["partial"] = true;
  line["ranges"] = ordered_json::array();
  for (const float range : scan.ranges)
    line["ranges"].push_back(range > 0.0F ? ordered_json(range) : ordered_json(nullptr));
  if (!scan.angles.empty()) line["angles"] = scan.angles;
  if (!scan.times.empty()) line["times"] = scan.times;
  if (!scan.intensities.empty()) line["intensities"] = scan.intensities;
  return line;
}

struct ToJson {
  ordered_json operator()(const std::vector<double>& values) const {
    ordered_json out = ordered_json::array();
    for (const double value : values)
      out.push_back(std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr));
    return out;
  }
  template <typename Other>
  ordered_json operator()(const Other& value) const {
    return value;
  }
};

std::string text_of(const ordered_json& line) {
  // Device text is data: what is not UTF-8 is replaced.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string message_text(const LidarMessage& message) {
  ordered_json line = {{"type", "message"}, {"name", message.name}};
  for (const auto& [key, value] : message.fields) line[key] = std::visit(ToJson{}, value);
  return text_of(line);
}

/// Lines in the order of the file. Packets are shown only when the file is too short for a whole turn.
class Lines {
 public:
  void add(const LidarMessage& message) { lines_.push_back({message_text(message), message.is_packet}); }
  void add(const LidarScan& scan) {
    lines_.push_back({text_of(scan_json(scan)), false});
    if (scan.partial || any_scan_) return;
    any_scan_ = true;
    std::erase_if(lines_, [](const Line& line) { return line.is_packet; });
  }
  [[nodiscard]] std::string text() const {
    std::string out;
    for (const Line& line : lines_)
      if (!line.is_packet || !any_scan_) out += line.text;
    return out;
  }

 private:
  struct Line {
    std::string text;
    bool is_packet = false;
  };
  std::vector<Line> lines_;
  bool any_scan_ = false;
};

/// A file has no arrival times: all times are the device's own, or counted samples.
class Feeder {
 public:
  explicit Feeder(Lidar& lidar) : lidar_(lidar) {
    lidar_.set_listener([this](const LidarMessage& message) { lines_.add(message); });
  }
  ~Feeder() { lidar_.set_listener(nullptr); }
  Feeder(const Feeder&) = delete;
  Feeder& operator=(const Feeder&) = delete;

  void feed(Bytes bytes) {
    while (!bytes.empty()) {
      const auto piece = bytes.first(std::min(decoding::kPiece, bytes.size()));
      lidar_.on_bytes(piece, 0.0);
      bytes = bytes.subspan(piece.size());
      take_scans();
    }
  }
  /// Input that was begun will never be completed.
  void interrupt() {
    lidar_.finish();
    take_scans();
    lidar_.reset();
  }
  void report(const LidarMessage& message) { lines_.add(message); }

  std::string finish(const Counters& also_rejected) {
    lidar_.finish();
    take_scans();
    if (const auto problem = lidar_.problem())
      lines_.add(LidarMessage{"problem", {{"text", problem->text()}}});
    Counters rejected = lidar_.rejected();
    rejected.insert(also_rejected.begin(), also_rejected.end());
    return lines_.text() + summary_line(lidar_.counters(), rejected);
  }

 private:
  void take_scans() {
    for (const LidarScan& scan : lidar_.take_scans()) lines_.add(scan);
  }

  Lidar& lidar_;
  Lines lines_;
};

/// Those of the device: from its usual port, or, where nothing came from there, the one with the most data.
std::vector<CapturedStream*> streams_of_device(std::vector<CapturedStream>& all, unsigned port) {
  std::vector<CapturedStream*> out;
  for (CapturedStream& one : all)
    if (one.from_port == port) out.push_back(&one);
  if (!out.empty() || all.empty()) return out;
  return {&*std::max_element(all.begin(), all.end(), [](const CapturedStream& a, const CapturedStream& b) {
    return a.stream.bytes() < b.stream.bytes();
  })};
}

LidarMessage stream_message(const CapturedStream& one, bool used) {
  const auto number = [](std::uint64_t value) { return static_cast<std::int64_t>(value); };
  return {"tcp_stream",
          {{"from", one.from},
           {"to", one.to},
           {"used", std::int64_t{used}},
           {"bytes", number(one.stream.bytes())},
           {"repeated_bytes", number(one.stream.repeated())},
           {"lost_bytes", number(one.stream.lost())}}};
}

}  // namespace

std::string decode_lidar(Lidar& lidar, Bytes bytes) {
  Feeder feeder(lidar);
  feeder.feed(bytes);
  return feeder.finish({});
}

Result<std::string> decode_lidar_capture(Lidar& lidar, unsigned port, std::string_view file,
                                         const std::string& where) {
  auto read = read_network_capture(file, where);
  if (!read) return read.error();
  NetworkCapture& capture = read.value();
  const std::vector<CapturedStream*> chosen = streams_of_device(capture.streams, port);
  if (chosen.empty())
    return Error{ErrorCode::format, "the network capture holds no data over TCP", where,
                 "capture at the host that is connected to the lidar, while it measures"};
  for (const CapturedStream* one : chosen)
    if (one->from != chosen.front()->from)
      return Error{ErrorCode::usage,
                   "the network capture holds several devices: " + chosen.front()->from + ", " + one->from,
                   where, "keep one: `tcpdump -r FILE -w ONE.pcap host ADDRESS`"};
  Feeder feeder(lidar);
  Counters rejected{{"capture_gaps", 0}, {"capture_cut_off", capture.cut_off.empty() ? 0U : 1U}};
  for (const CapturedStream& one : capture.streams)
    feeder.report(stream_message(one, std::find(chosen.begin(), chosen.end(), &one) != chosen.end()));
  if (!capture.cut_off.empty()) feeder.report({"capture_cut_off", {{"text", capture.cut_off}}});
  for (CapturedStream* one : chosen) {
    if (one != chosen.front()) feeder.interrupt();
    for (const TcpStreamBytes::Run& run : one->stream.take()) {
      if (run.after_gap) feeder.interrupt();
      feeder.feed(run.bytes);
    }
    rejected["capture_gaps"] += one->stream.gaps();
  }
  return feeder.finish(rejected);
}

}  // namespace odomcalib::drivers
