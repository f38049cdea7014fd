// Neato XV-11: one-way serial, counter-clockwise, 360 readings a turn, no clock of its own.
#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/xv11/packet.hpp"
#include "drivers/lidar/xv11/settings.hpp"

namespace odomcalib::drivers {
namespace {

class Xv11 final : public Lidar {
 public:
  explicit Xv11(const LidarOptions& options);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(finder_.frames().rejected()); }

 private:
  void on_packet(const xv11::Packet& packet, double now);
  void report_packet(const xv11::Packet& packet) const;

  LidarOptions options_;
  xv11::PacketFinder finder_;
  SampleClock clock_;
  Sweep sweep_;
  std::optional<unsigned> last_index_;
};

constexpr double kDegreesPerPacket = 4.0;

}  // namespace

Xv11::Xv11(const LidarOptions& options)
    : options_(options), clock_(options.device_time), sweep_(xv11::kLimits) {}

void Xv11::reset() {
  finder_.reset();
  clock_.reset();
  sweep_.reset();
  last_index_.reset();
}

void Xv11::report_packet(const xv11::Packet& packet) const {
  if (!has_listener()) return;
  std::vector<double> angles, ranges;
  std::vector<std::int64_t> strengths, weak;
  for (std::size_t i = 0; i < xv11::kReadings; ++i) {
    const xv11::Reading& reading = packet.readings[i];
    angles.push_back(radians(kDegreesPerPacket * packet.index + static_cast<double>(i)));
    ranges.push_back(reading.range_mm > 0 ? 1e-3 * reading.range_mm : kNoReading);
    strengths.push_back(reading.strength);
    weak.push_back(reading.weak ? 1 : 0);
  }
  report({"xv11_packet",
          {{"index", std::int64_t{packet.index}},
           {"rpm", packet.rpm},
           {"angles", std::move(angles)},
           {"ranges", std::move(ranges)},
           {"intensities", std::move(strengths)},
           {"weak", std::move(weak)}},
          true});
}

/// The unit sends each packet when it is measured: the last reading is as old as the transmission.
void Xv11::on_packet(const xv11::Packet& packet, double now) {
  const unsigned passed = last_index_ ? (packet.index + xv11::kPackets - *last_index_) % xv11::kPackets : 1;
  if (passed == 0) return finder_.frames().reject("repeated_packets");
  finder_.frames().reject("lost_packets", passed - 1);
  const bool wraps = packet.index == 0 || (last_index_ && packet.index < *last_index_);
  last_index_ = packet.index;

  const double packet_s = 60.0 / packet.rpm / xv11::kPackets;
  const double arrival = now - wire_time(packet.bytes_after, options_.baud);
  const auto stamp = clock_.on_packet(passed * packet_s, arrival);
  if (!stamp.continuous) sweep_.interrupt();
  if (wraps) sweep_.begin_turn();
  const double t_last = stamp.t - wire_time(xv11::kPacketBytes, options_.baud);
  const double reading_s = clock_.rate() * packet_s / xv11::kReadings;
  for (std::size_t i = 0; i < xv11::kReadings; ++i) {
    const double angle = kDegreesPerPacket * packet.index + static_cast<double>(i);
    const double t = t_last - reading_s * static_cast<double>(xv11::kReadings - 1 - i);
    const xv11::Reading& reading = packet.readings[i];
    sweep_.add({t, radians(angle), 1e-3 * reading.range_mm, static_cast<double>(reading.strength)},
               radians(1.0));
  }
  report_packet(packet);
}

void Xv11::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  for (const xv11::Packet& packet : finder_.on_bytes(bytes)) on_packet(packet, now);
}

Counters Xv11::counters() const {
  Counters all = finder_.frames().counters();
  sweep_.count_into(all);
  return all;
}

std::unique_ptr<Lidar> make_xv11(const LidarOptions& options) { return std::make_unique<Xv11>(options); }

}  // namespace odomcalib::drivers
