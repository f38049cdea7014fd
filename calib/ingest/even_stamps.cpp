#include "calib/ingest/even_stamps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

constexpr std::size_t kFewest = 50;
constexpr double kEven = 3e-4;      // s; nothing moves so fast that it mattered
constexpr std::size_t kReach = 30;  // samples to either side
constexpr std::size_t kLong = 100;  // samples over which a period is measured
constexpr double kFewLost = 3.0;    // times the usual interval: what the mean one may be to count lost ones
constexpr double kUnambiguous =
    0.2;  // of an interval: spread up to which the number that it spans is certain

/// Of an index, over long stretches.
double period_of(const std::vector<double>& stamps, const std::vector<double>& index) {
  const std::size_t length = std::min(kLong, stamps.size() / 3);
  std::vector<double> slopes;
  for (std::size_t k = length; k < stamps.size(); ++k)
    slopes.push_back((stamps[k] - stamps[k - length]) / (index[k] - index[k - length]));
  return math::median_of(std::move(slopes));
}

std::vector<double> numbered(std::size_t count) {
  std::vector<double> index(count);
  for (std::size_t k = 0; k < count; ++k) index[k] = static_cast<double>(k);
  return index;
}

/// How many periods lie before each sample. One that comes late and is followed by others at once was held up
/// with them: no more samples are missing than the time of all together allows.
std::vector<double> steps_of(const std::vector<double>& intervals, double usual) {
  constexpr double kHeldUp = 1.5, kAtOnce = 0.5;  // times the usual interval
  std::vector<double> steps;
  for (std::size_t k = 0; k < intervals.size();) {
    double total = intervals[k], count = 1.0;
    std::size_t next = k + 1;
    if (intervals[k] > kHeldUp * usual)
      for (; next < intervals.size() && intervals[next] < kAtOnce * usual; ++next, ++count)
        total += intervals[next];
    steps.push_back(std::max(count, std::round(total / usual)) - (count - 1.0));
    steps.resize(next, 1.0);
    k = next;
  }
  return steps;
}

/// Counts lost samples in where intervals are regular enough for it; otherwise one after the other.
std::vector<double> indices_of(const std::vector<double>& stamps) {
  std::vector<double> index = numbered(stamps.size());
  const std::vector<double> intervals = math::differences_of(stamps);
  const double usual = math::median_of(intervals);
  if (!(usual > 0.0) || period_of(stamps, index) > kFewLost * usual ||
      math::deviation_about(usual, intervals) > kUnambiguous * usual)
    return index;
  const std::vector<double> steps = steps_of(intervals, usual);
  for (std::size_t k = 1; k < stamps.size(); ++k) index[k] = index[k - 1] + steps[k - 1];
  return index;
}

/// Mean of what lies within three deviations of the median: whatever follows a step is not part of it.
double middle_of(const std::vector<double>& values) {
  const double median = math::median_of(values);
  const double limit = 3.0 * math::deviation_about(median, values);
  double sum = 0.0, count = 0.0;
  for (const double value : values)
    if (std::abs(value - median) <= limit) {
      sum += value;
      count += 1.0;
    }
  return sum / count;
}

/// Of up to kReach samples on either side, as many on both.
std::vector<double> running_middle(const std::vector<double>& values) {
  std::vector<double> middles;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t reach = std::min({kReach, k, values.size() - 1 - k});
    const auto here = values.begin() + static_cast<std::ptrdiff_t>(k);
    const auto width = static_cast<std::ptrdiff_t>(reach);
    middles.push_back(middle_of({here - width, here + width + 1}));
  }
  return middles;
}

/// By the mean absolute deviation, which single late ones enter as well.
double jitter_of(const std::vector<double>& stamps, const std::vector<double>& even) {
  double sum = 0.0;
  for (std::size_t k = 0; k < stamps.size(); ++k) sum += std::abs(stamps[k] - even[k]);
  return std::sqrt(math::kPi / 2.0) * sum / static_cast<double>(stamps.size());
}

}  // namespace

std::optional<EvenStamps> even_stamps(const std::vector<double>& stamps) {
  if (stamps.size() < kFewest) return std::nullopt;
  const std::vector<double> index = indices_of(stamps);
  const double period = period_of(stamps, index);
  std::vector<double> even;
  for (std::size_t k = 0; k < stamps.size(); ++k) even.push_back(stamps[k] - period * index[k]);
  even = running_middle(even);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    even[k] += period * index[k];
    if (k > 0) even[k] = std::max(even[k], even[k - 1]);
  }
  const double jitter = jitter_of(stamps, even);
  if (!(jitter > kEven)) return std::nullopt;
  return EvenStamps{std::move(even), jitter};
}

}  // namespace odomcalib::calib::ingest
