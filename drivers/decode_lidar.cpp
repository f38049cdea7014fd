#include "drivers/decode_parts.hpp"
#include "drivers/lidar/ld06/ld06.hpp"

namespace odomcalib::drivers {
namespace {

using nlohmann::ordered_json;

constexpr unsigned kBaud =
    230'400;  // bytes of a file are fed packet by packet, so the rate dates nothing here

ordered_json scan_json(const Scan& scan) {
  ordered_json ranges = ordered_json::array();
  for (const float range : scan.ranges)
    ranges.push_back(range > 0.0F ? ordered_json(range) : ordered_json(nullptr));
  ordered_json line = {{"type", "scan"},
                       {"t", scan.t},
                       {"device_time", scan.t},
                       {"angle_min", scan.angle_min},
                       {"angle_increment", scan.angle_increment},
                       {"time_increment", scan.time_increment.value_or(0.0)},
                       {"range_min", scan.range_min},
                       {"range_max", scan.range_max}};
  line["ranges"] = std::move(ranges);
  line["angles"] = scan.angles;
  line["times"] = scan.times;
  line["intensities"] = scan.intensities;
  return line;
}

ordered_json packet_json(const ld06::Packet& packet) {
  ordered_json line = {{"type", "message"},
                       {"name", "ld06_packet"},
                       {"speed_deg_s", packet.speed_deg_s},
                       {"start_deg", 0.01 * packet.start_cdeg},
                       {"end_deg", 0.01 * ((packet.start_cdeg + packet.span_cdeg) % 36'000)},
                       {"device_time", 1e-3 * packet.stamp_ms}};
  for (const ld06::Point& point : packet.points) {
    line["ranges"].push_back(point.range_mm == 0 ? ordered_json(nullptr)
                                                 : ordered_json(1e-3 * point.range_mm));
    line["intensities"].push_back(point.intensity);
  }
  return line;
}

/// Seconds of the device's clock without its wrap.
class Unwrapped {
 public:
  double operator()(unsigned stamp_ms) {
    total_ms_ += (stamp_ms + ld06::kClockModulus_ms - last_) % ld06::kClockModulus_ms;
    last_ = stamp_ms;
    return 1e-3 * static_cast<double>(total_ms_);
  }

 private:
  unsigned last_ = 0;
  std::uint64_t total_ms_ = 0;
};

}  // namespace

/// A file has no arrival times: each packet is taken to arrive at its own stamp, so that times are the
/// device's.
std::string decode_ld06(std::span<const std::uint8_t> bytes) {
  ld06::PacketFinder finder(4500.0);
  Ld06 lidar(kBaud);
  Unwrapped clock;
  std::string out;
  std::vector<ld06::Packet> packets;
  std::size_t given = 0;
  double now = 0.0;
  bool any_scan = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto found = finder.on_bytes(bytes.subspan(i, 1));
    if (found.empty()) continue;
    packets.push_back(found.front());
    now = clock(found.front().stamp_ms);
    lidar.on_bytes(bytes.subspan(given, i + 1 - given), now);
    given = i + 1;
    for (const Scan& scan : lidar.take_scans()) {
      out += scan_json(scan).dump() + "\n";
      any_scan = true;
    }
  }
  lidar.on_bytes(bytes.subspan(given), now);
  if (!any_scan)  // too little for a whole turn: then the packets themselves are what can be shown
    for (const ld06::Packet& packet : packets) out += packet_json(packet).dump() + "\n";
  return out + summary_line(lidar.counters(), {"bad_checksum", "bad_field", "bad_span", "motor_stopped",
                                               "short_scans", "partial_scans"});
}

}  // namespace odomcalib::drivers
