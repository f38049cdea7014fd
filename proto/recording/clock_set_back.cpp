#include "proto/recording/clock_set_back.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib {
namespace {

// Samples on either side that a step needs. Chosen: of two, one may have come late.
constexpr std::size_t kFewest = 3;
// Share of as many samples as fit into the time by which a clock was set back, that lie in that time: on
// either side of the step. Derived: where a block of m samples comes before the n that belong there, it is
// m / (m + n) on one side and n / (m + n) on the other, never more than half on both; the rest is left to
// samples that get lost.
constexpr double kFull = 0.8;
// Times that stamps of one stream go back. Chosen: of more, samples are out of order; each looks at as many
// as the clock was set back by.
constexpr std::size_t kMostSteps = 20;
// Intervals by which a sample may miss that time. Derived: the next one belongs to another.
constexpr double kMisses = 0.5;

double usual_interval(std::span<const double> stamps) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < stamps.size(); ++k)
    if (stamps[k] > stamps[k - 1]) intervals.push_back(stamps[k] - stamps[k - 1]);
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

bool is_full(std::span<const double> stamps, double begin, double end) {
  const auto inside =
      std::count_if(stamps.begin(), stamps.end(), [&](double t) { return t >= begin && t <= end; });
  return static_cast<double>(inside) >= kFull * static_cast<double>(stamps.size());
}

/// Samples whose stamps lie before the one before them by as long as kFewest samples take.
std::vector<std::size_t> far_back(std::span<const double> stamps, double usual) {
  std::vector<std::size_t> found;
  for (std::size_t k = 1; k < stamps.size() && found.size() <= kMostSteps; ++k)
    if (stamps[k - 1] - stamps[k] > (static_cast<double>(kFewest) - 1.5) * usual) found.push_back(k);
  return found;
}

/// @param first sample whose stamp is earlier than the one before
bool goes_on(std::span<const double> stamps, std::size_t first, double usual) {
  const double back = stamps[first - 1] - stamps[first];
  const auto in_that_time = static_cast<std::size_t>(std::lround(std::min(back / usual, 1e9))) + 1;
  const std::size_t count = std::min({in_that_time, first, stamps.size() - first});
  if (count < kFewest || in_that_time < kFewest) return false;
  const double miss = kMisses * usual, time = static_cast<double>(count - 1) * usual + miss;
  return is_full(stamps.subspan(first - count, count), stamps[first - 1] - time, stamps[first - 1] + miss) &&
         is_full(stamps.subspan(first, count), stamps[first] - miss, stamps[first] + time);
}

}  // namespace

std::vector<SetBack> set_back(std::span<const double> stamps) {
  std::vector<SetBack> steps;
  const double usual = usual_interval(stamps);
  if (!(usual > 0.0)) return steps;
  const std::vector<std::size_t> candidates = far_back(stamps, usual);
  if (candidates.size() > kMostSteps) return steps;
  for (const std::size_t k : candidates)
    if (goes_on(stamps, k, usual)) steps.push_back({k, stamps[k - 1] + usual - stamps[k]});
  return steps;
}

std::vector<double> without_steps(std::vector<double> stamps, std::span<const SetBack> steps) {
  for (const SetBack& step : steps)
    for (std::size_t k = step.first; k < stamps.size(); ++k) stamps[k] += step.by;
  return stamps;
}

}  // namespace odomcalib
