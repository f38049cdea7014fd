// LDROBOT LD06, LD19 (STL-06P, STL-19P): one-way serial, clockwise, a packet of 12 points each 2.67 ms.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/ld06/packet.hpp"
#include "drivers/lidar/ld06/settings.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

using namespace ld06;

namespace {

class Ld06 final : public Lidar {
 public:
  Ld06(const LidarOptions& options, double points_per_s);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  /// Those of the packets and of the sweep, and lost_packets.
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override;

 private:
  double date();
  void begin_turn();
  void add(const ld06::Packet& packet, double t_end);
  void report_packet(const ld06::Packet& packet) const;

  LidarOptions options_;
  double nominal_period_;  // s between packets
  ld06::PacketFinder finder_;
  DeviceClock clock_;
  std::optional<double> last_end_;  // s, filtered end of the last packet on the device's clock
  double host_offset_ = 0.0;        // s, of the turn in progress
  double period_;                   // s between packets, measured
  double last_angle_ = 0.0;         // degrees, clockwise
  Sweep sweep_;
  std::uint64_t lost_packets_ = 0;
};

}  // namespace

Ld06::Ld06(const LidarOptions& options, double points_per_s)
    : options_(options),
      nominal_period_(static_cast<double>(ld06::kPoints) / points_per_s),
      finder_(points_per_s),
      clock_(ld06::kClockModulus_ms, 1e-3, options.device_time),
      period_(nominal_period_),
      sweep_(points_per_s > kLongFrom_hz ? kLongLimits : kLimits) {}

void Ld06::reset() {
  finder_.reset();
  clock_.reset();
  last_end_.reset();
  sweep_.reset();
}

/// End of the packet's measurement on the device's clock, s. Stamps have steps of 1 ms while packets are
/// equidistant: a slow filter on the packet period takes the steps out. Arrivals have no say here, so a busy
/// host that reads late or in bursts tears no turn apart.
double Ld06::date() {
  const double stamped = clock_.device() + kHalfStamp_s;
  const double steps = last_end_ ? std::max(1.0, std::round((stamped - *last_end_) / period_)) : 0.0;
  const double predicted = last_end_ ? *last_end_ + steps * period_ : stamped;
  const double error = stamped - predicted;
  const bool hole = steps * period_ > kResync_s || std::abs(error) > kResync_s;
  if (!last_end_ || hole) {
    sweep_.interrupt();
    last_end_ = stamped;
    return stamped;
  }
  if (steps > 1.0) lost_packets_ += static_cast<std::uint64_t>(steps) - 1;
  last_end_ = predicted + kPhaseGain * error;
  period_ = std::clamp(period_ + kPeriodGain * error, 0.5 * nominal_period_, 2.0 * nominal_period_);
  return *last_end_;
}

/// One offset for all beams of a turn, so that an offset that is learnt does not bend the turn.
void Ld06::begin_turn() {
  sweep_.begin_turn();
  host_offset_ = clock_.offset();
}

void Ld06::add(const ld06::Packet& packet, double t_end) {
  const double step = 0.01 * packet.span_cdeg / static_cast<double>(ld06::kPoints - 1);
  const double sample = period_ / static_cast<double>(ld06::kPoints);
  for (std::size_t i = 0; i < ld06::kPoints; ++i) {
    const ld06::Point& point = packet.points[i];
    const double angle = std::fmod(0.01 * packet.start_cdeg + step * static_cast<double>(i), 360.0);
    if (angle < last_angle_ - 180.0) begin_turn();
    last_angle_ = angle;
    const double t = host_offset_ + t_end - sample * static_cast<double>(ld06::kPoints - 1 - i);
    sweep_.add({t, -radians(angle), 1e-3 * point.range_mm, static_cast<double>(point.intensity)},
               radians(step));
  }
}

void Ld06::report_packet(const ld06::Packet& packet) const {
  if (!has_listener()) return;
  std::vector<double> ranges;
  std::vector<std::int64_t> intensities;
  for (const ld06::Point& point : packet.points) {
    ranges.push_back(point.range_mm == 0 ? kNoReading : 1e-3 * point.range_mm);
    intensities.push_back(point.intensity);
  }
  report({"ld06_packet",
          {{"speed_deg_s", std::int64_t{packet.speed_deg_s}},
           {"start_deg", 0.01 * packet.start_cdeg},
           {"end_deg", 0.01 * ((packet.start_cdeg + packet.span_cdeg) % 36'000)},
           {"device_time", 1e-3 * packet.stamp_ms},
           {"ranges", std::move(ranges)},
           {"intensities", std::move(intensities)}},
          true});
}

void Ld06::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  for (const ld06::Packet& packet : finder_.on_bytes(bytes)) {
    // The device sends as soon as it has measured: the packet's own transmission lies between.
    clock_.to_host(packet.stamp_ms, now - wire_time(packet.bytes_after + ld06::kPacketBytes, options_.baud));
    if (!last_end_) host_offset_ = clock_.offset();
    add(packet, date());
    report_packet(packet);
  }
}

Counters Ld06::counters() const {
  Counters all = finder_.frames().counters();
  sweep_.count_into(all);
  all["lost_packets"] = lost_packets_;
  return all;
}

Counters Ld06::rejected() const { return sweep_.rejected(finder_.frames().rejected()); }

std::unique_ptr<Lidar> make_ld06(const LidarOptions& options, double points_per_s) {
  return std::make_unique<Ld06>(options, points_per_s);
}

}  // namespace odomcalib::drivers
