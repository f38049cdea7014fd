#include "drivers/lidar/ld06/ld06.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::drivers {
namespace {

constexpr double kRangeMin_m = 0.02;  // data sheet
constexpr double kRangeMax_m = 12.0;  // data sheet
constexpr double kHalfStamp_s =
    0.5e-3;  // the stamp is cut off to whole milliseconds: half of one is lost on average
constexpr double kPhaseGain = 0.05;  // of the filter that smooths the stamp's 1 ms steps
constexpr double kPeriodGain = 0.0005;
constexpr double kResync_s = 0.02;
constexpr double kUsualShare = 0.9;  // of the points of a turn; less is a short scan
constexpr std::size_t kMostBeams =
    20'000;  // a turn at the slowest speed that passes the span check, and more

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Millimetres to metres; what the sensor cannot measure is no reading.
float range_of(const ld06::Point& point) {
  const double range = 1e-3 * point.range_mm;
  return range < kRangeMin_m || range > kRangeMax_m ? 0.0F : static_cast<float>(range);
}

}  // namespace

void Ld06::reset() {
  finder_.reset();
  clock_.reset();
  last_end_.reset();
  drop_sweep();
}

void Ld06::drop_sweep() {
  whole_ = false;
  sweep_.clear();
  step_sum_ = 0.0;
  packets_in_sweep_ = 0;
}

/// End of the packet's measurement, s. Stamps have steps of 1 ms while packets are equidistant: a slow filter
/// on the packet period takes the steps out.
double Ld06::date(const ld06::Packet& packet, double now) {
  const double arrival = now - 10.0 * static_cast<double>(packet.bytes_after) / baud_;
  const double stamped = clock_.to_host(packet.stamp_ms, arrival) + kHalfStamp_s;
  const double steps = last_end_ ? std::round((stamped - *last_end_) / period_) : 0.0;
  const double predicted = last_end_ ? *last_end_ + steps * period_ : stamped;
  const double error = stamped - predicted;
  if (!last_end_ || steps < 1.0 || steps * period_ > kResync_s) {
    if (last_end_) drop_sweep();  // a hole in the sweep
    last_end_ = stamped;
  } else {
    if (steps > 1.0) lost_packets_ += static_cast<std::uint64_t>(steps) - 1;
    last_end_ = predicted + kPhaseGain * error;
    period_ = std::clamp(period_ + kPeriodGain * error, 0.5 * 12.0 / 4500.0, 2.0 * 12.0 / 4500.0);
  }
  return *last_end_;
}

void Ld06::add(const ld06::Packet& packet, double t_end) {
  const double step = 0.01 * packet.span_cdeg / static_cast<double>(ld06::kPoints - 1);
  const double sample = period_ / static_cast<double>(ld06::kPoints);
  for (std::size_t i = 0; i < ld06::kPoints; ++i) {
    const double angle = std::fmod(0.01 * packet.start_cdeg + step * static_cast<double>(i), 360.0);
    if (!sweep_.empty() && angle < sweep_.back().clockwise - 180.0) finish_sweep();
    if (sweep_.size() >= kMostBeams) drop_sweep();
    sweep_.push_back({t_end - sample * static_cast<double>(ld06::kPoints - 1 - i), angle, packet.points[i]});
  }
  step_sum_ += step;
  ++packets_in_sweep_;
}

void Ld06::finish_sweep() {
  const double step = packets_in_sweep_ > 0 ? step_sum_ / static_cast<double>(packets_in_sweep_) : 0.0;
  const bool enough = static_cast<double>(sweep_.size()) * step >= kUsualShare * 360.0;
  if (!whole_) {
    ++partial_;
  } else if (!enough) {
    ++short_;
  } else {
    ++published_;
    scans_.push_back(make_scan());
  }
  drop_sweep();
  whole_ = true;
}

Scan Ld06::make_scan() const {
  Scan scan;
  const double n = static_cast<double>(sweep_.size() - 1);
  scan.t = sweep_.front().t;
  scan.angle_min = -radians(sweep_.front().clockwise);
  scan.angle_increment = -radians((sweep_.back().clockwise - sweep_.front().clockwise) / n);
  scan.time_increment = (sweep_.back().t - sweep_.front().t) / n;
  scan.range_min = kRangeMin_m;
  scan.range_max = kRangeMax_m;
  for (const Beam& beam : sweep_) {
    scan.ranges.push_back(range_of(beam.point));
    scan.angles.push_back(static_cast<float>(-radians(beam.clockwise)));
    scan.times.push_back(static_cast<float>(beam.t - scan.t));
    scan.intensities.push_back(static_cast<float>(beam.point.intensity));
  }
  return scan;
}

void Ld06::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  for (const ld06::Packet& packet : finder_.on_bytes(bytes)) {
    const double t_end = date(packet, now);
    add(packet, t_end);
  }
}

std::vector<Scan> Ld06::take_scans() { return std::exchange(scans_, {}); }

Counters Ld06::counters() const {
  Counters all = finder_.counters();
  all["scans"] = published_;
  all["short_scans"] = short_;
  all["partial_scans"] = partial_;
  all["lost_packets"] = lost_packets_;
  return all;
}

}  // namespace odomcalib::drivers
