#include "proto/recording/scan_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib {
namespace {

constexpr std::size_t kMostBeams = 100'000;
constexpr double kLargestRange = 10'000.0;  // m

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool is_grid(const Scan& scan) {
  return std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment) && scan.angle_increment != 0.0;
}

// m; lidars that measure 80 m see nothing at most bearings.
constexpr double kFarthestMedian = 60.0;
// m, where the median reading lies for most robots. Chosen: the unit that is nearest is named.
constexpr double kUsualMedian = 2.5;

constexpr std::array kRangeUnits = {RangeUnit{"millimetres", 1e-3}, RangeUnit{"centimetres", 1e-2},
                                    RangeUnit{"inches", 0.0254}};
constexpr const char* kLooksLike = ": they look like ";

/// The unit in which all of these would lie within the limits; null where they may be metres, or one value
/// that stands for no reading.
const RangeUnit* unit_of(std::vector<float> outside, const Scan& scan) {
  if (outside.empty() || !(scan.range_max > 0.0)) return nullptr;
  std::sort(outside.begin(), outside.end());
  const double median = static_cast<double>(outside[outside.size() / 2]);
  if (!(median > kFarthestMedian) || outside.front() == outside.back()) return nullptr;
  const RangeUnit* found = nullptr;
  const auto distance = [&](const RangeUnit& unit) {
    return std::abs(std::log(median * unit.size / kUsualMedian));
  };
  for (const RangeUnit& unit : kRangeUnits) {
    if (static_cast<double>(outside.back()) * unit.size > scan.range_max) continue;
    if (found == nullptr || distance(unit) < distance(*found)) found = &unit;
  }
  return found;
}

/// Replaces what is no distance by 0 ("no reading").
BeamProblems clean_ranges(Scan& scan) {
  BeamProblems problems;
  std::vector<float> outside;
  bool all_outside = true;
  // Limits and ranges were rounded on their own ways to float: allow for one unit in the last place.
  const auto nearest = static_cast<float>(scan.range_min) * (1.0F - 1e-6F);
  const auto farthest =
      static_cast<float>(scan.range_max > 0.0 ? scan.range_max : kLargestRange) * (1.0F + 1e-6F);
  for (float& range : scan.ranges) {
    if (range == 0.0F) continue;
    const bool number = std::isfinite(range);
    if (number && range > 0.0F && range >= nearest && range <= farthest) {
      all_outside = false;
      continue;
    }
    ++(number ? problems.out_of_limits : problems.not_a_number);
    if (number && range > 0.0F && all_outside) outside.push_back(range);
    range = 0.0F;
  }
  if (all_outside) problems.unit = unit_of(std::move(outside), scan);
  return problems;
}

void complete_scan(Scan& scan) {
  if (!std::isfinite(scan.range_min) || scan.range_min < 0.0) scan.range_min = 0.0;
  if (!std::isfinite(scan.range_max) || scan.range_max <= 0.0) scan.range_max = 0.0;
  if (!std::isfinite(scan.angle_min)) scan.angle_min = 0.0;
  if (!std::isfinite(scan.angle_increment)) scan.angle_increment = 0.0;
  if (scan.time_increment && !(std::isfinite(*scan.time_increment) && *scan.time_increment > 0.0))
    scan.time_increment.reset();
}

/// A lidar that states no limit: the farthest reading is the best that is known.
void set_missing_range_max(Scan& scan) {
  if (scan.range_max > 0.0) return;
  scan.range_max = static_cast<double>(*std::max_element(scan.ranges.begin(), scan.ranges.end()));
}

template <typename Value>
void reorder(std::vector<Value>& values, const std::vector<std::size_t>& order) {
  if (values.empty()) return;
  std::vector<Value> sorted;
  sorted.reserve(values.size());
  for (const std::size_t k : order) sorted.push_back(values[k]);
  values = std::move(sorted);
}

/// Some drivers list beams in another order than they were sent. Walls are found among neighbours in the
/// list, and the sweep runs from its first to its last beam. A grid of angles states an order of its own.
void list_in_time_order(Scan& scan) {
  if (scan.angles.empty() || std::is_sorted(scan.times.begin(), scan.times.end())) return;
  std::vector<std::size_t> order(scan.times.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scan.times[a] < scan.times[b]; });
  reorder(scan.ranges, order);
  reorder(scan.angles, order);
  reorder(scan.times, order);
  reorder(scan.intensities, order);
}

}  // namespace

const char* scan_problem(const Scan& scan) {
  const std::size_t beams = scan.ranges.size();
  if (beams == 0) return "no ranges";
  if (beams > kMostBeams) return "more than 100000 beams";
  if (!scan.angles.empty() && scan.angles.size() != beams) return "angles do not match ranges";
  if (!scan.times.empty() && scan.times.size() != beams) return "times do not match ranges";
  if (scan.angles.empty() && !is_grid(scan)) return "angle_min or angle_increment missing or impossible";
  if (!all_finite(scan.angles)) return "an angle is not a number";
  if (!all_finite(scan.times)) return "a beam time is not a number";
  return nullptr;
}

std::string reason_outside_limits(const RangeUnit* unit) {
  return unit == nullptr ? std::string(kOutsideLimits)
                         : std::string(kOutsideLimits) + kLooksLike + unit->name;
}

const RangeUnit* range_unit_of_reason(const std::string& reason) {
  const auto* const unit = std::find_if(kRangeUnits.begin(), kRangeUnits.end(), [&](const RangeUnit& one) {
    return reason == reason_outside_limits(&one);
  });
  return unit == kRangeUnits.end() ? nullptr : unit;
}

void list_backwards(Scan& scan) {
  if (scan.ranges.empty()) return;
  scan.angle_min += static_cast<double>(scan.ranges.size() - 1) * scan.angle_increment;
  scan.angle_increment = -scan.angle_increment;
  for (auto* values : {&scan.ranges, &scan.angles, &scan.intensities})
    std::reverse(values->begin(), values->end());
}

void list_first_sent_first(Scan& scan) {
  if (!(scan.time_increment.value_or(0.0) < 0.0) || !scan.times.empty() || scan.ranges.empty()) return;
  scan.t += static_cast<double>(scan.ranges.size() - 1) * *scan.time_increment;
  scan.time_increment = -*scan.time_increment;
  list_backwards(scan);
}

BeamProblems clean_scan(Scan& scan) {
  complete_scan(scan);
  list_in_time_order(scan);
  const auto problems = clean_ranges(scan);
  set_missing_range_max(scan);
  return problems;
}

}  // namespace odomcalib
