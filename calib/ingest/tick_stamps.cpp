#include "calib/ingest/tick_stamps.hpp"

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"

namespace odomcalib::calib::ingest {
namespace {

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
