#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/decode/decode_parts.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kPiece =
    256;  // bytes fed at once, so that messages and scans come in the order of the file

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

}  // namespace

/// A file has no arrival times: all times are the device's own, or counted samples.
std::string decode_lidar(Lidar& lidar, std::span<const std::uint8_t> bytes) {
  Lines lines;
  lidar.set_listener([&lines](const LidarMessage& message) { lines.add(message); });
  while (!bytes.empty()) {
    const auto piece = bytes.first(std::min(kPiece, bytes.size()));
    lidar.on_bytes(piece, 0.0);
    bytes = bytes.subspan(piece.size());
    for (const LidarScan& scan : lidar.take_scans()) lines.add(scan);
  }
  lidar.finish();
  for (const LidarScan& scan : lidar.take_scans()) lines.add(scan);
  lidar.set_listener(nullptr);
  return lines.text() + summary_line(lidar.counters(), lidar.rejected());
}

}  // namespace odomcalib::drivers
