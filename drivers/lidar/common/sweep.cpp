#include "drivers/lidar/common/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/lidar/common/settings.hpp"

namespace odomcalib::drivers {

using namespace lidar;

void Sweep::reset() {
  whole_ = false;
  covered_ = 0.0;
  beams_.clear();
}

void Sweep::add(const Beam& beam, double step) {
  if (beams_.size() >= kMostBeams) interrupt();
  beams_.push_back(beam);
  covered_ += std::abs(step);
}

void Sweep::give_out(bool partial) {
  if (!beams_.empty()) scans_.push_back(make_scan(partial));
  reset();
}

void Sweep::begin_turn() {
  const bool enough = covered_ >= kUsualShare * 2.0 * std::numbers::pi;
  if (!whole_) {
    partial_ += beams_.empty() ? 0 : 1;
  } else {
    ++(enough ? published_ : short_);
  }
  give_out(!whole_ || !enough);
  whole_ = true;
}

void Sweep::interrupt() {
  if (!beams_.empty()) ++partial_;
  give_out(true);
}

/// Directions of beams in one piece, without the jump where the sensor's angle wraps. A turn begins near its
/// zero.
std::vector<double> Sweep::unwrapped_angles() const {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  std::vector<double> out;
  for (const Beam& beam : beams_) {
    const double first = whole_ ? std::remainder(beam.angle, kTurn) : beam.angle;
    out.push_back(out.empty() ? first : out.back() + std::remainder(beam.angle - out.back(), kTurn));
  }
  return out;
}

LidarScan Sweep::make_scan(bool partial) const {
  LidarScan out;
  out.partial = partial;
  Scan& scan = out.scan;
  const double steps = std::max(1.0, static_cast<double>(beams_.size()) - 1.0);
  scan.t = beams_.front().t;
  const std::vector<double> angles = unwrapped_angles();
  scan.angle_min = angles.front();
  scan.angle_increment = (angles.back() - angles.front()) / steps;
  scan.time_increment = (beams_.back().t - beams_.front().t) / steps;
  scan.range_min = limits_.range_min;
  scan.range_max = limits_.range_max;
  scan.angles.assign(angles.begin(), angles.end());
  for (const Beam& beam : beams_) {
    const bool valid = beam.range >= limits_.range_min && beam.range <= limits_.range_max;
    scan.ranges.push_back(valid ? static_cast<float>(beam.range) : 0.0F);
    scan.times.push_back(static_cast<float>(beam.t - scan.t));
    if (limits_.intensities) scan.intensities.push_back(static_cast<float>(beam.intensity));
  }
  return out;
}

std::vector<LidarScan> Sweep::take_scans() { return std::exchange(scans_, {}); }

void Sweep::count_into(Counters& counters) const {
  counters["scans"] = published_;
  counters["short_scans"] = short_;
  counters["partial_scans"] = partial_;
}

Counters Sweep::rejected(Counters rejections) const {
  rejections["short_scans"] = short_;
  rejections["partial_scans"] = partial_;
  return rejections;
}

}  // namespace odomcalib::drivers
