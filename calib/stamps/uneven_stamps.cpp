#include "calib/stamps/uneven_stamps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "calib/stamps/stamp_contest.hpp"
#include "calib/statistics/median.hpp"

namespace odomcalib::calib {
namespace {

/// Of intervals between stamps, that of two samples which come at once, s; zero where most do anyway.
double at_once(const std::vector<TickSample>& ticks) {
  constexpr double kAtOnce = 0.1;  // of the usual interval
  std::vector<double> intervals = differences_of(stamps_of(ticks));
  if (intervals.empty()) return 0.0;
  const double mean = (ticks.back().t - ticks.front().t) / static_cast<double>(intervals.size());
  return median_of(std::move(intervals)) > kAtOnce * mean ? kAtOnce * mean : 0.0;
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

/// What was sent twice happened once.
std::vector<double> with_repeats(const std::vector<double>& times, const std::vector<std::size_t>& kept,
                                 std::size_t count) {
  std::vector<double> all;
  for (std::size_t k = 0, next = 0; k < count; ++k) {
    if (next < kept.size() && kept[next] == k) ++next;
    all.push_back(times[next - 1]);
  }
  return all;
}

/// Of the value in the middle, from the line through its neighbours.
double misfit(std::span<const double> t, const std::array<double, 3>& value) {
  const double share = t[2] > t[0] ? (t[1] - t[0]) / (t[2] - t[0]) : 0.5;
  return value[1] - value[0] - share * (value[2] - value[0]);
}

/// Of the counts of one wheel; what stands still knows no time.
void compare(const std::vector<TickSample>& ticks, std::int64_t TickSample::*wheel,
             const std::vector<double>& given, const std::vector<double>& even, StampContest& contest) {
  for (std::size_t k = 0; k + 2 < ticks.size(); ++k) {
    if (ticks[k].segment != ticks[k + 2].segment || ticks[k].*wheel == ticks[k + 2].*wheel) continue;
    const auto since = [&](std::size_t j) { return static_cast<double>(ticks[j].*wheel - ticks[k].*wheel); };
    const std::array<double, 3> counts = {0.0, since(k + 1), since(k + 2)};
    contest.add(misfit({given.data() + k, 3}, counts), misfit({even.data() + k, 3}, counts));
  }
}

/// The same intervals with each end moved as the scan's stamp was.
std::vector<Interval> moved(const std::vector<SensorPair>& pairs, const std::vector<double>& given,
                            const std::vector<double>& even) {
  const auto moved_time = [&](double time) {
    const auto after = std::upper_bound(given.begin(), given.end(), time) - given.begin();
    const auto scan = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
    return time + even[scan] - given[scan];
  };
  std::vector<Interval> intervals;
  intervals.reserve(pairs.size());
  for (const SensorPair& pair : pairs)
    intervals.push_back({moved_time(pair.interval.begin), moved_time(pair.interval.end)});
  return intervals;
}

/// In deviations of the match.
Eigen::Vector3d error_of(const SensorPair& pair, const Pose& predicted) {
  const Eigen::Vector3d error(pair.motion.x - predicted.x, pair.motion.y - predicted.y,
                              wrap_angle(pair.motion.yaw - predicted.yaw));
  return error.array() / pair.covariance.diagonal().array().sqrt();
}

}  // namespace

std::optional<EvenStamps> even_ticks(const Recording& recording) {
  const std::vector<std::size_t> kept = without_repeats(recording.ticks);
  std::vector<TickSample> ticks;
  ticks.reserve(kept.size());
  for (const std::size_t k : kept) ticks.push_back(recording.ticks[k]);
  const std::vector<double> given = stamps_of(ticks);
  auto even = even_stamps(given);
  if (!even) return std::nullopt;
  StampContest contest;
  compare(ticks, &TickSample::left, given, even->t, contest);
  compare(ticks, &TickSample::right, given, even->t, contest);
  if (!contest.is_for_even()) return std::nullopt;
  even->t = with_repeats(even->t, kept, recording.ticks.size());
  return even;
}

std::optional<EvenStamps> even_scans(const Recording& recording, const FitData& data,
                                     const EffectList& effects, const Eigen::VectorXd& parameters) {
  const std::vector<double> given = stamps_of(recording.scans);
  auto even = even_stamps(given);
  if (!even) return std::nullopt;
  std::vector<Interval> intervals;
  intervals.reserve(data.pairs.size());
  for (const SensorPair& pair : data.pairs) intervals.push_back(pair.interval);
  const Trajectory odometry = data.model->trajectory(as_span(parameters), effects);
  const auto by_given = odometry.sensor_motions(intervals);
  const auto by_even = odometry.sensor_motions(moved(data.pairs, given, even->t));
  StampContest contest;
  for (std::size_t k = 0; k < data.pairs.size(); ++k) {
    const Eigen::Vector3d a = error_of(data.pairs[k], by_given[k]), b = error_of(data.pairs[k], by_even[k]);
    for (Eigen::Index c = 0; c < 3; ++c) contest.add(a(c), b(c));
  }
  return contest.is_for_even() ? even : std::nullopt;
}

}  // namespace odomcalib::calib
