#include "proto/recording/tick_counts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace odomcalib {
namespace {

// No robot that this program calibrates drives faster; nominal diameters may be wrong by a factor of three.
constexpr double kFastest = 10.0;  // m/s
// A step of one sample that stands out from both its neighbours by so much is a jump, not motion: wheels
// neither reach such an acceleration nor end it with the same deceleration one sample later. The floor allows
// for slip and coarse stamps.
constexpr double kSpikeAcceleration = 30.0;  // m/s^2
constexpr double kSpikeSpeed = 1.0;          // m/s
// Times the upper quartile of the speeds: beyond it a step is none of this recording, whatever unit its
// values are in. Chosen: a robot that is driven at 3 m/s or less keeps the limit above.
constexpr double kTimesUsual = 10.0 / 3.0;
// Neighbours over which steps are taken for that: two or three programs that write in turn make every step
// from one sample to the next a jump, and none from one of theirs to the next of theirs.
constexpr std::size_t kWritersInTurn = 3;

// Steps of a count in which wheels at rest may rock about zero. Chosen.
constexpr std::int64_t kRockingSteps = 8;
// Counts. Derived: the finer counts of wheel_motion.hpp, of an encoder with 256 counts a turn; steps that are
// larger are motion.
constexpr std::int64_t kCoarsestStep = 4096;

using Counts = std::array<std::int64_t, 2>;

struct Step {
  Counts change{};
  Counts wraps{};  // what was added to the raw difference, as a count offset
};

/// Both counts always fit into `bits`, signed or unsigned: only then can they wrap there.
struct Width {
  std::int64_t modulus;
  bool possible;
};

using Widths = std::array<Width, 2>;

bool fits(const std::vector<TickSample>& ticks, std::int64_t modulus) {
  const auto inside = [&](std::int64_t low) {
    return std::all_of(ticks.begin(), ticks.end(), [&](const TickSample& s) {
      return s.left >= low && s.left < low + modulus && s.right >= low && s.right < low + modulus;
    });
  };
  return inside(0) || inside(-modulus / 2);
}

Widths widths_of(const std::vector<TickSample>& ticks) {
  return {Width{std::int64_t{1} << 16, fits(ticks, std::int64_t{1} << 16)},
          Width{std::int64_t{1} << 32, fits(ticks, std::int64_t{1} << 32)}};
}

/// The upper median of at least one value.
double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Over many samples: where a bus hands over several at a time, most intervals are next to nothing.
double median_interval(const std::vector<TickSample>& ticks) {
  constexpr std::size_t kMostAtATime = 20;
  if (ticks.size() < 2) return 0.1;
  const std::size_t n = std::min(kMostAtATime, ticks.size() - 1);
  std::vector<double> intervals;
  intervals.reserve(ticks.size() - n);
  for (std::size_t i = n; i < ticks.size(); ++i)
    intervals.push_back((ticks[i].t - ticks[i - n].t) / static_cast<double>(n));
  return std::max(middle_of(std::move(intervals)), 1e-3);
}

/// Between samples in which a count is another: a controller may be asked more often than it counts anew, and
/// steps then come all at once.
double interval_of_changes(const std::vector<TickSample>& ticks) {
  constexpr double kLongest = 0.5;  // s; longer ones are stops
  std::vector<double> intervals;
  double last = ticks.empty() ? 0.0 : ticks.front().t;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (ticks[i].left == ticks[i - 1].left && ticks[i].right == ticks[i - 1].right) continue;
    if (ticks[i].t - last < kLongest) intervals.push_back(ticks[i].t - last);
    last = ticks[i].t;
  }
  return intervals.empty() ? 0.0 : middle_of(std::move(intervals));
}

/// Speeds in m/s from counts, with the nominal geometry.
class Speeds {
 public:
  Speeds(const std::vector<TickSample>& ticks, const RobotDescription& robot)
      : floor_(std::max(median_interval(ticks), interval_of_changes(ticks))), metres_per_tick_(0.0) {
    const double diameter = std::max(robot.left_wheel_diameter, robot.right_wheel_diameter);
    if (diameter > 0.0 && robot.ticks_per_rev > 0.0)
      metres_per_tick_ = diameter * std::numbers::pi / robot.ticks_per_rev;
    stretch_ = std::max(1.0, kTimesUsual * usual_speed(ticks) / kFastest);
  }
  [[nodiscard]] bool known() const { return metres_per_tick_ > 0.0; }
  /// Jittering stamps make short intervals: never divide by less than the usual one.
  [[nodiscard]] double operator()(std::int64_t change, double interval) const {
    return static_cast<double>(change) * metres_per_tick_ / usual_interval(interval);
  }
  [[nodiscard]] double usual_interval(double interval) const { return std::max(interval, floor_); }
  /// Speed of one count in an interval: a slow wheel seems to have it, or not, by when its count comes.
  [[nodiscard]] double of_one_count(double interval) const { return (*this)(1, interval); }
  [[nodiscard]] bool possible(std::int64_t change, double interval) const {
    return !known() || std::abs((*this)(change, interval)) <= stretch_ * kFastest + of_one_count(interval);
  }
  /// How many times the usual limits of speed and acceleration hold for this recording: more than once where
  /// its values or its robot are in another unit. Whether they are is judged later, by the motion of the
  /// reference.
  [[nodiscard]] double stretch() const { return stretch_; }

 private:
  /// m/s, upper quartile of the faster wheel while either turns.
  [[nodiscard]] double usual_speed(const std::vector<TickSample>& ticks) const {
    double least = 0.0;
    for (std::size_t lag = 1; lag <= kWritersInTurn; ++lag) {
      const double speed = quartile_of_speeds(ticks, lag);
      least = lag == 1 ? speed : std::min(least, speed);
    }
    return least;
  }

  [[nodiscard]] double quartile_of_speeds(const std::vector<TickSample>& ticks, std::size_t lag) const {
    std::vector<double> speeds;
    for (std::size_t i = lag; i < ticks.size(); ++i) {
      const TickSample &from = ticks[i - lag], &to = ticks[i];
      const double left = static_cast<double>(to.left) - static_cast<double>(from.left);
      const double right = static_cast<double>(to.right) - static_cast<double>(from.right);
      const double most = std::max(std::abs(left), std::abs(right));
      if (most > 0.0)
        speeds.push_back(most * metres_per_tick_ /
                         usual_interval((to.t - from.t) / static_cast<double>(lag)) /
                         static_cast<double>(lag));
    }
    if (speeds.empty()) return 0.0;
    const auto place = speeds.begin() + static_cast<std::ptrdiff_t>(3 * speeds.size() / 4);
    std::nth_element(speeds.begin(), place, speeds.end());
    return *place;
  }

  double floor_;
  double metres_per_tick_;
  double stretch_ = 1.0;
};

/// The smaller of the raw difference and the same difference wrapped once in either direction.
std::int64_t nearest_wrap(std::int64_t difference, const Widths& widths) {
  std::int64_t best = difference;
  for (const auto& width : widths) {
    if (!width.possible) continue;
    for (const std::int64_t offset : {-width.modulus, width.modulus})
      if (std::abs(difference + offset) < std::abs(best)) best = difference + offset;
  }
  return best;
}

/// Counters that both return to exactly zero by more than one sample's motion were reset.
/// @param finest smallest_step()
bool is_reset(const TickSample& now, const Counts& change, const Counts& previous_change,
              std::int64_t finest) {
  if (now.left != 0 || now.right != 0) return false;
  const auto unlike = [&](std::int64_t step, std::int64_t usual) {
    return std::abs(step - usual) > 2 * std::abs(usual) + kRockingSteps * finest;
  };
  return unlike(change[0], previous_change[0]) || unlike(change[1], previous_change[1]);
}

/// Differences that int64 cannot hold come only from garbage.
std::optional<std::int64_t> difference(std::int64_t now, std::int64_t before) {
  std::int64_t out = 0;
  if (__builtin_sub_overflow(now, before, &out) || out == INT64_MIN) return std::nullopt;
  return out;
}

/// The least by which a count changes: one, of an encoder; more, where its counts were turned into angles
/// and those into the finer counts of this program. One where nothing changes.
std::int64_t smallest_step(const std::vector<TickSample>& ticks) {
  std::int64_t smallest = 0;
  const auto look = [&](std::int64_t now, std::int64_t before) {
    const std::int64_t step = std::abs(difference(now, before).value_or(0));
    if (step > 0 && (smallest == 0 || step < smallest)) smallest = step;
  };
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    look(ticks[i].left, ticks[i - 1].left);
    look(ticks[i].right, ticks[i - 1].right);
  }
  return std::clamp<std::int64_t>(smallest, 1, kCoarsestStep);
}

// Times the usual interval: across a longer one samples were lost, and a counter that wraps at a small number
// may have wrapped more than once. Chosen, between one interval and two.
constexpr double kLostSamples = 1.5;

/// The step before, from which the next one is expected.
struct UsualStep {
  Counts counts{};
  double interval = 0.0;  // s
};

struct Change {
  Counts counts{};
  bool continued = false;
  bool misread = false;  ///< the count that it leads to
};

class Continuation {
 public:
  Continuation(const std::vector<TickSample>& ticks, const RobotDescription& robot)
      : speeds_(ticks, robot),
        widths_(widths_of(ticks)),
        moduli_(counter_moduli(ticks)),
        finest_(smallest_step(ticks)) {}

  [[nodiscard]] const std::array<CounterModulus, 2>& moduli() const { return moduli_; }

  [[nodiscard]] std::vector<Change> changes(const std::vector<TickSample>& ticks) const {
    std::vector<Change> out(ticks.size());
    UsualStep usual;
    bool lost = false;
    for (std::size_t i = 1; i < ticks.size(); ++i) {
      const bool rests =
          i > 1 && is_unchanged(ticks[i - 2], ticks[i - 1]) && is_unchanged(ticks[i - 1], ticks[i]);
      if (rests) usual = {};
      out[i] = between(ticks[i - 1], ticks[i], usual);
      // Fast counters tell the motion by the step before, and where that is not known, by the next rest.
      lost = is_fast() && !rests && (lost || !out[i].continued);
      if (lost) out[i].continued = false;
      if (out[i].continued) usual = {out[i].counts, ticks[i].t - ticks[i - 1].t};
    }
    mend_glitches(ticks, out);
    break_at_spikes(ticks, out);
    return out;
  }

 private:
  [[nodiscard]] bool is_fast() const { return moduli_[0].is_fast || moduli_[1].is_fast; }

  static bool is_unchanged(const TickSample& before, const TickSample& now) {
    return before.segment == now.segment && before.left == now.left && before.right == now.right;
  }

  /// Nothing where the counter may have gone on by more than the samples tell.
  [[nodiscard]] std::optional<std::int64_t> step_of(std::size_t side, std::int64_t difference,
                                                    double interval, const UsualStep& usual) const {
    const CounterModulus& own = moduli_.at(side);
    if (own.suspected != 0 && std::abs(static_cast<double>(difference)) > own.jump) return std::nullopt;
    if (own.modulus == 0) return nearest_wrap(difference, widths_);
    const double intervals = speeds_.usual_interval(interval) / speeds_.usual_interval(usual.interval);
    const double expected = static_cast<double>(usual.counts.at(side)) * intervals;
    const bool samples_were_lost = intervals > kLostSamples;
    if (samples_were_lost && std::abs(expected) > 0.5 * static_cast<double>(own.modulus)) return std::nullopt;
    return nearest_step(difference, own.modulus, own.is_fast || samples_were_lost ? expected : 0.0);
  }

  [[nodiscard]] Change between(const TickSample& before, const TickSample& now,
                               const UsualStep& usual) const {
    if (before.segment != now.segment) return {};
    const auto left = difference(now.left, before.left);
    const auto right = difference(now.right, before.right);
    if (!left || !right) return {};
    const double interval = now.t - before.t;
    const auto left_step = step_of(0, *left, interval, usual),
               right_step = step_of(1, *right, interval, usual);
    if (!left_step || !right_step) return {};
    const Counts counts{*left_step, *right_step};
    // A counter that wraps passes zero as any other number.
    if (is_reset(now, counts, usual.counts, finest_)) return {};
    const bool possible = speeds_.possible(counts[0], interval) && speeds_.possible(counts[1], interval);
    return {counts, possible};
  }

  [[nodiscard]] double excess(const Change& change, const Change& other, double interval,
                              double other_interval, std::size_t side) const {
    return std::abs(speeds_(change.counts.at(side), interval) -
                    speeds_(other.counts.at(side), other_interval));
  }

  /// More than wheels can change by from one step to the next.
  [[nodiscard]] double limit(double interval) const {
    return speeds_.stretch() * std::max(kSpikeSpeed, kSpikeAcceleration * speeds_.usual_interval(interval)) +
           2.0 * speeds_.of_one_count(interval);
  }

  /// @param share of the limit
  [[nodiscard]] bool in_line(const Change& change, double interval, const Change& other,
                             double other_interval, double share) const {
    const double most = share * limit(interval);
    return change.continued && excess(change, other, interval, other_interval, 0) <= most &&
           excess(change, other, interval, other_interval, 1) <= most;
  }

  /// One sample that neither continues the one before nor is continued by the one after, while these two
  /// continue each other, was read wrong. The motion across it is shared out over both its steps.
  void mend_glitches(const std::vector<TickSample>& ticks, std::vector<Change>& changes) const {
    constexpr double kClear = 0.5;  // neither step may pass for motion while the other breaks the track
    if (!speeds_.known()) return;
    for (std::size_t i = 2; i + 1 < ticks.size(); ++i) {
      const Change& before = changes[i - 1];
      if (!before.continued) continue;
      const double usual = ticks[i - 1].t - ticks[i - 2].t, to = ticks[i].t - ticks[i - 1].t,
                   from = ticks[i + 1].t - ticks[i].t;
      if (in_line(changes[i], to, before, usual, kClear) ||
          in_line(changes[i + 1], from, before, usual, kClear))
        continue;
      const Change across = between(ticks[i - 1], ticks[i + 1], {before.counts, usual});
      if (!in_line(across, to + from, before, usual, 1.0)) continue;
      changes[i] = changes[i + 1] = across;
      changes[i].misread = true;
      for (std::size_t side = 0; side < 2; ++side) {
        const auto whole = static_cast<double>(across.counts.at(side));
        changes[i].counts.at(side) = std::llround(whole * to / (to + from));
        changes[i + 1].counts.at(side) -= changes[i].counts.at(side);
      }
    }
  }

  void break_at_spikes(const std::vector<TickSample>& ticks, std::vector<Change>& changes) const {
    if (!speeds_.known()) return;
    for (std::size_t i = 2; i + 1 < ticks.size(); ++i) {
      if (!changes[i].continued || !changes[i - 1].continued || !changes[i + 1].continued) continue;
      const double interval = ticks[i].t - ticks[i - 1].t;
      const double most = limit(interval);
      for (std::size_t side = 0; side < 2; ++side)
        if (excess(changes[i], changes[i - 1], interval, ticks[i - 1].t - ticks[i - 2].t, side) > most &&
            excess(changes[i], changes[i + 1], interval, ticks[i + 1].t - ticks[i].t, side) > most)
          changes[i].continued = false;
    }
  }

  Speeds speeds_;
  Widths widths_;
  std::array<CounterModulus, 2> moduli_;
  std::int64_t finest_;
};

}  // namespace

ContinuedCounts continue_counts(std::vector<TickSample>& ticks, const RobotDescription& robot) {
  const Continuation continuation(ticks, robot);
  const auto changes = continuation.changes(ticks);
  ContinuedCounts found;
  found.moduli = continuation.moduli();
  std::int32_t segment = 0, given = 0;
  Counts counts{};
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (changes[i].misread) ++found.misread;
    if (i > 0 && !changes[i].continued && ticks[i].segment == given) ++found.jumps;
    given = ticks[i].segment;
    if (i == 0 || !changes[i].continued) {
      segment += i == 0 ? 0 : 1;
      counts = {ticks[i].left, ticks[i].right};
    } else {
      counts = {counts[0] + changes[i].counts[0], counts[1] + changes[i].counts[1]};
    }
    ticks[i].left = counts[0];
    ticks[i].right = counts[1];
    ticks[i].segment = segment;
  }
  found.breaks = static_cast<std::size_t>(segment);
  return found;
}

}  // namespace odomcalib
