#include "calib/ingest/even_stamps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

/// Period of an index, over long stretches.
double period_of(const std::vector<double>& stamps, const std::vector<double>& index) {
  const std::size_t length = std::min(settings::kPeriodSamples, stamps.size() / 3);
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
/// with them: no more samples are missing than the time of all together allows. Nor are more than the time
/// from the sample before, or to the sample after, allows: a single stamp that is early or late misses none.
std::vector<double> steps_of(const std::vector<double>& intervals, double usual) {
  const auto periods = [usual](double time) { return std::round(time / usual); };
  std::vector<double> steps;
  double time_before = usual, steps_before = 1.0;
  for (std::size_t k = 0; k < intervals.size();) {
    double total = intervals[k], count = 1.0;
    std::size_t next = k + 1;
    if (intervals[k] > settings::kHeldUp * usual)
      for (; next < intervals.size() && intervals[next] < settings::kFollowsAtOnce * usual; ++next, ++count)
        total += intervals[next];
    double all = std::min(periods(total), periods(time_before + total) - steps_before);
    if (count == 1.0 && next < intervals.size())
      all = std::min(all, periods(total + intervals[next]) - std::max(1.0, periods(intervals[next])));
    all = std::max(all, count);
    steps.push_back(all - (count - 1.0));
    steps.resize(next, 1.0);
    time_before = total, steps_before = all;
    k = next;
  }
  return steps;
}

/// Counts lost samples in where intervals are regular enough for it; otherwise one after the other.
std::vector<double> indices_of(const std::vector<double>& stamps) {
  std::vector<double> index = numbered(stamps.size());
  const std::vector<double> intervals = math::differences_of(stamps);
  const double usual = math::median_of(intervals);
  if (!(usual > 0.0) || period_of(stamps, index) > settings::kFewLost * usual ||
      math::deviation_about(usual, intervals) > settings::kCertainCount * usual)
    return index;
  const std::vector<double> steps = steps_of(intervals, usual);
  for (std::size_t k = 1; k < stamps.size(); ++k) index[k] = index[k - 1] + steps[k - 1];
  return index;
}

/// Mean of what lies within three deviations of the median: whatever follows a step is not part of it.
double middle_of(const std::vector<double>& values) {
  const double median = math::median_of(values);
  const double limit = settings::kMiddleSigmas * math::deviation_about(median, values);
  double sum = 0.0, count = 0.0;
  for (const double value : values)
    if (std::abs(value - median) <= limit) {
      sum += value;
      count += 1.0;
    }
  return sum / count;
}

/// Running middle of up to kMiddleReach samples on either side, as many on both.
std::vector<double> running_middle(const std::vector<double>& values) {
  std::vector<double> middles;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t reach = std::min({settings::kMiddleReach, k, values.size() - 1 - k});
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

/// Interval between stamps below which two samples come at once, s; zero where most do anyway.
double at_once(const std::vector<TickSample>& ticks) {
  std::vector<double> intervals = math::differences_of(stamps_of(ticks));
  if (intervals.empty()) return 0.0;
  const double mean = (ticks.back().t - ticks.front().t) / static_cast<double>(intervals.size());
  return math::median_of(std::move(intervals)) > settings::kSentAtOnce * mean ? settings::kSentAtOnce * mean
                                                                              : 0.0;
}

/// The same counts once more, at the same time, while the robot moves: sent twice.
bool is_repeat(const std::vector<TickSample>& ticks, std::size_t k, double soon) {
  if (k < 2 || ticks[k].t - ticks[k - 1].t >= soon) return false;
  const auto moves = [&](std::size_t a, std::size_t b) {
    return ticks[a].left != ticks[b].left || ticks[a].right != ticks[b].right;
  };
  return !moves(k - 1, k) && moves(k - 2, k - 1);
}

/// Numbers of the others.
std::vector<std::size_t> without_repeats(const std::vector<TickSample>& ticks) {
  std::vector<std::size_t> kept;
  const double soon = at_once(ticks);
  for (std::size_t k = 0; k < ticks.size(); ++k)
    if (!is_repeat(ticks, k, soon)) kept.push_back(k);
  return kept;
}

/// Counts that were sent twice happened once.
std::vector<double> with_repeats(const std::vector<double>& times, const std::vector<std::size_t>& kept,
                                 std::size_t count) {
  std::vector<double> all;
  for (std::size_t k = 0, next = 0; k < count; ++k) {
    if (next < kept.size() && kept[next] == k) ++next;
    all.push_back(times[next - 1]);
  }
  return all;
}

/// Deviation of the value in the middle from the line through its neighbours.
double misfit(std::span<const double> t, const std::array<double, 3>& value) {
  const double share = t[2] > t[0] ? (t[1] - t[0]) / (t[2] - t[0]) : 0.5;
  return value[1] - value[0] - share * (value[2] - value[0]);
}

/// Compares both sets of stamps by the counts of one wheel; a wheel that stands still knows no time.
void compare(const std::vector<TickSample>& ticks, std::int64_t TickSample::*wheel,
             const std::vector<double>& given, const std::vector<double>& even, StampComparison& contest) {
  for (std::size_t k = 0; k + 2 < ticks.size(); ++k) {
    if (ticks[k].segment != ticks[k + 2].segment || ticks[k].*wheel == ticks[k + 2].*wheel) continue;
    const auto since = [&](std::size_t j) { return static_cast<double>(ticks[j].*wheel - ticks[k].*wheel); };
    const std::array<double, 3> counts = {0.0, since(k + 1), since(k + 2)};
    contest.add(misfit({given.data() + k, 3}, counts), misfit({even.data() + k, 3}, counts));
  }
}

}  // namespace

std::optional<EvenStamps> even_stamps(const std::vector<double>& stamps) {
  if (stamps.size() < settings::kFewestStamps) return std::nullopt;
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
  if (!(jitter > settings::kEvenEnough_s)) return std::nullopt;
  return EvenStamps{std::move(even), jitter};
}

bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k)
    if (times[k + 1] - times[k] > settings::kMaxGap_s) return true;
  return false;
}

/// Least squares with what lies beyond `limit` of the line of share `near` cut down to it (Huber, Ann. Math.
/// Stat. 35, 1964).
StampComparison::Share StampComparison::share(double limit, double near) const {
  double product = 0.0, square = 0.0, variance = 0.0;
  const auto weight_of = [&](const Error& e) {
    const double residual = std::abs(e.given - near * e.difference);
    return residual > limit ? limit / residual : 1.0;
  };
  for (const Error& e : errors_) {
    product += weight_of(e) * e.given * e.difference;
    square += weight_of(e) * e.difference * e.difference;
  }
  if (!(square > 0.0)) return {0.0, std::numeric_limits<double>::infinity()};
  const double value = product / square;
  for (const Error& e : errors_)
    variance += std::pow(weight_of(e) * e.difference * (e.given - value * e.difference), 2);
  return {value, std::sqrt(variance) / square};
}

double StampComparison::spread(double share) const {
  std::vector<double> residuals;
  residuals.reserve(errors_.size());
  for (const Error& e : errors_) residuals.push_back(e.given - share * e.difference);
  return math::deviation_about(0.0, std::move(residuals));
}

bool StampComparison::even_is_better() const {
  if (errors_.empty()) return false;
  Share found{0.5, 0.0};
  for (int round = 0; round < settings::kContestRounds; ++round)
    found = share(settings::kContestLimit * spread(found.value), found.value);
  return found.value - settings::kEvenSigmas * found.deviation > settings::kEvenShare;
}

std::optional<EvenStamps> even_ticks(const Recording& recording) {
  const std::vector<std::size_t> kept = without_repeats(recording.ticks);
  std::vector<TickSample> ticks;
  ticks.reserve(kept.size());
  for (const std::size_t k : kept) ticks.push_back(recording.ticks[k]);
  const std::vector<double> given = stamps_of(ticks);
  auto even = even_stamps(given);
  if (!even) return std::nullopt;
  StampComparison contest;
  compare(ticks, &TickSample::left, given, even->t, contest);
  compare(ticks, &TickSample::right, given, even->t, contest);
  if (!contest.even_is_better()) return std::nullopt;
  even->t = with_repeats(even->t, kept, recording.ticks.size());
  return even;
}

}  // namespace odomcalib::calib::ingest
