#include "proto/recording/scan_parts.hpp"

#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace odomcalib {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;  // rad

/// rad, to the nearest of equal directions.
double apart(double angle) { return std::remainder(angle, kTurn); }

bool times_go_on(const Scan& before, const Scan& after) {
  if (before.times.empty() || after.times.empty()) return before.times.empty() && after.times.empty();
  return after.times.front() > before.times.back();
}

bool goes_on(const Scan& before, const Scan& after) {
  if (before.t != after.t || before.sensor != after.sensor || before.ranges.empty() || after.ranges.empty())
    return false;
  if (before.angles.empty() != after.angles.empty() || !times_go_on(before, after)) return false;
  const double step = mean_step(before), size = std::abs(step);
  if (!(size > 0.0) || std::abs(mean_step(after) - step) > kSameStepOfParts * size) return false;
  const double beams = static_cast<double>(before.ranges.size()) + static_cast<double>(after.ranges.size());
  if (beams * size > kTurn + 0.5 * size) return false;
  return std::abs(apart(after.angle(0) - before.angle(before.ranges.size() - 1) - step)) <
         kNextBeamOfParts * size;
}

void append(std::vector<float>& list, const std::vector<float>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

void append(Scan& scan, const Scan& part) {
  const bool both_shine =
      scan.intensities.size() == scan.ranges.size() && part.intensities.size() == part.ranges.size();
  if (both_shine)
    append(scan.intensities, part.intensities);
  else
    scan.intensities.clear();
  append(scan.ranges, part.ranges);
  append(scan.angles, part.angles);
  append(scan.times, part.times);
}

}  // namespace

double mean_step(const Scan& scan) {
  if (scan.angles.empty()) return scan.angle_increment;
  double swept = 0.0;
  for (std::size_t k = 1; k < scan.angles.size(); ++k) swept += apart(scan.angle(k) - scan.angle(k - 1));
  return scan.angles.size() < 2 ? 0.0 : swept / static_cast<double>(scan.angles.size() - 1);
}

std::size_t join_parts_of_one_stamp(std::vector<Scan>& scans) {
  if (scans.empty()) return 0;
  auto kept = scans.begin();
  for (auto next = std::next(kept); next != scans.end(); ++next) {
    if (goes_on(*kept, *next))
      append(*kept, *next);
    else if (++kept != next)
      *kept = std::move(*next);
  }
  const auto joined = static_cast<std::size_t>(std::distance(kept, scans.end())) - 1;
  scans.erase(std::next(kept), scans.end());
  return joined;
}

}  // namespace odomcalib
