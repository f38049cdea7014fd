#include "calib/estimation/clock_step.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "calib/estimation/settings.hpp"
#include "calib/ingest/form.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "calib/measurement/reference_motion.hpp"

namespace odomcalib::calib::estimation {
namespace {

/// Rotation of the wheels in each pair's interval, seen with a delay.
using Turns = std::vector<Eigen::Vector2d>;

/// Residual of the measured rotation of each pair, for delays on a grid: squares in units of the noise,
/// bounded, added up from the first pair.
class Costs {
 public:
  Costs(const measurement::FitData& one, const std::vector<double>& delays)
      : delays_(delays), yaws_(one.pairs.size()) {
    for (std::size_t k = 0; k < yaws_.size(); ++k) yaws_[k] = one.pairs[k].motion.yaw;
    for (const double delay : delays) {
      Turns turns;
      for (const wheels::WheelMotion& m : measurement::wheel_motions({&one, 1}, delay))
        turns.emplace_back(m.left, m.right);
      turns_.push_back(std::move(turns));
    }
  }

  [[nodiscard]] std::size_t pairs() const { return yaws_.size(); }
  [[nodiscard]] double delay(std::size_t d) const { return delays_[d]; }

  /// By least squares with bounded residuals, of pairs each seen with a delay of its own.
  [[nodiscard]] Eigen::Vector2d gains(const std::vector<std::size_t>& delay_of_pair) const {
    Eigen::Vector2d gains = Eigen::Vector2d::Zero();
    double bound = 1e9;
    for (int round = 0; round < settings::kGainRounds; ++round) {
      Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-9;
      Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
      for (std::size_t k = 0; k < pairs(); ++k) {
        const Eigen::Vector2d& turned = turns_[delay_of_pair[k]][k];
        const double residual = std::abs(yaws_[k] - gains.dot(turned));
        const double weight = residual > bound ? bound / residual : 1.0;
        normal += weight * turned * turned.transpose();
        right_side += weight * yaws_[k] * turned;
      }
      gains = math::solve_symmetric(normal, right_side);
      bound = std::max(std::sqrt(settings::kGrossTurnSquared) * noise(delay_of_pair, gains), 1e-6);
    }
    return gains;
  }

  /// rad, robust deviation of what these gains leave.
  [[nodiscard]] double noise(const std::vector<std::size_t>& delay_of_pair,
                             const Eigen::Vector2d& gains) const {
    std::vector<double> misfits;
    for (std::size_t k = 0; k < pairs(); ++k)
      misfits.push_back(yaws_[k] - gains.dot(turns_[delay_of_pair[k]][k]));
    return std::max(math::deviation_about(0.0, std::move(misfits)), settings::kLeastTurnNoise_rad);
  }

  void weigh(const Eigen::Vector2d& gains, double noise) {
    sums_.clear();
    for (std::size_t d = 0; d < turns_.size(); ++d) {
      std::vector<double> sum(pairs() + 1, 0.0);
      for (std::size_t k = 0; k < pairs(); ++k) {
        const double between = 0.5 * gains.dot(turns_[d][k] - turns_[d > 0 ? d - 1 : d + 1][k]);
        const double misfit = yaws_[k] - gains.dot(turns_[d][k]);
        // The right delay lies between two of the grid.
        const double squared = misfit * misfit / (noise * noise + between * between);
        sum[k + 1] = sum[k] + std::min(squared, settings::kGrossTurnSquared);
      }
      sums_.push_back(std::move(sum));
    }
  }

  [[nodiscard]] double cost(std::size_t d, std::size_t from, std::size_t to) const {
    return sums_[d][to] - sums_[d][from];
  }

  struct Best {
    std::size_t delay = 0;
    double cost = 0.0;
  };
  [[nodiscard]] Best best(std::size_t from, std::size_t to) const {
    Best best{0, cost(0, from, to)};
    for (std::size_t d = 1; d < delays_.size(); ++d)
      if (const double other = cost(d, from, to); other < best.cost) best = {d, other};
    return best;
  }

 private:
  const std::vector<double>& delays_;
  std::vector<double> yaws_;
  std::vector<Turns> turns_;               // by delay, pair
  std::vector<std::vector<double>> sums_;  // by delay, pairs before
};

std::vector<double> grid(double middle, double reach, double step) {
  std::vector<double> delays;
  const auto steps = static_cast<int>(std::lround(reach / step));
  for (int k = -steps; k <= steps; ++k) delays.push_back(middle + step * k);
  return delays;
}

struct Split {
  std::size_t pair = 0;               ///< the first after the step
  std::size_t before = 0, after = 0;  ///< delays
  double cost = 0.0;
};

Split best_split(const Costs& costs) {
  const std::size_t n = costs.pairs(), fewest = settings::kFewestPairsOfClock;
  Split best{n, 0, 0, 0.0};
  for (std::size_t k = fewest; k + fewest <= n; ++k) {
    const Costs::Best before = costs.best(0, k), after = costs.best(k, n);
    if (best.pair == n || before.cost + after.cost < best.cost)
      best = {k, before.delay, after.delay, before.cost + after.cost};
  }
  return best;
}

/// The least cost of a delay that goes steadily from one of the grid to another.
double best_drift(const Costs& costs, std::size_t delays) {
  double best = costs.best(0, costs.pairs()).cost;
  const auto n = static_cast<double>(costs.pairs());
  for (std::size_t from = 0; from < delays; from += 2)
    for (std::size_t to = 0; to < delays; to += 2) {
      double sum = 0.0;
      for (std::size_t k = 0; k < costs.pairs() && sum < best; ++k) {
        const double place =
            static_cast<double>(from) +
            (static_cast<double>(to) - static_cast<double>(from)) * (static_cast<double>(k) + 0.5) / n;
        sum += costs.cost(static_cast<std::size_t>(std::lround(place)), k, k + 1);
      }
      best = std::min(best, sum);
    }
  return best;
}

std::vector<std::size_t> delays_of(const Split& split, std::size_t pairs) {
  std::vector<std::size_t> delays(pairs, split.after);
  std::fill(delays.begin(), delays.begin() + static_cast<std::ptrdiff_t>(split.pair), split.before);
  return delays;
}

/// Split, gains and noise depend on each other: the gains of a wrong split are too small.
Split settled_split(Costs& costs) {
  Split split{costs.pairs(), costs.best(0, costs.pairs()).delay, 0, 0.0};
  for (int round = 0; round < settings::kSplitRounds; ++round) {
    const auto delays = delays_of(split, costs.pairs());
    const Eigen::Vector2d gains = costs.gains(delays);
    costs.weigh(gains, costs.noise(delays, gains));
    split = best_split(costs);
  }
  return split;
}

/// The best delay of some pairs to a fraction of the grid.
double fine_delay(const measurement::FitData& one, std::size_t from, std::size_t to, double about) {
  const auto begin = one.pairs.begin();
  const measurement::FitData part{
      one.model, {begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to)}};
  const std::vector<double> delays = grid(about, settings::kSplitStep_s, settings::kFineSplitStep_s);
  Costs costs(part, delays);
  const std::vector<std::size_t> middle(part.pairs.size(), delays.size() / 2);
  const Eigen::Vector2d gains = costs.gains(middle);
  costs.weigh(gains, costs.noise(middle, gains));
  return delays[costs.best(0, part.pairs.size()).delay];
}

/// The stream whose stamps show the step: its clock was set.
enum class Shown { nowhere, in_reference, in_counts };

struct Place {
  double moment = 0.0;  ///< s, of the first sample of the reference after the step
  Shown shown = Shown::nowhere;
};

/// The interval that is least like the others, of those near.
struct OddInterval {
  double begin = 0.0, end = 0.0;
  double unlike = 0.0;  ///< s, by which it is longer, or shorter where shorter ones are looked for
};

OddInterval odd_interval(const std::vector<double>& times, double about, double reach, bool longer) {
  const double usual = math::median_of(math::differences_of(times));
  OddInterval most;
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (std::abs(times[k] - about) > reach) continue;
    const double unlike = (times[k] - times[k - 1] - usual) * (longer ? 1.0 : -1.0);
    if (unlike > most.unlike) most = {times[k - 1], times[k], unlike};
  }
  return most;
}

Place place_of(const Recording& recording, const ClockStep& rough) {
  const double reach = settings::kMomentReach_s + std::abs(rough.size);
  const double least = settings::kShownPart * std::abs(rough.size);
  const bool ahead = rough.size > 0.0;
  const OddInterval of_reference =
      odd_interval(stamps_of(recording, ingest::reference_of(recording)), rough.moment, reach, ahead);
  // Counts that were set ahead leave a gap between the last count before the step and the first after it.
  if (!ahead) {
    const OddInterval of_counts =
        odd_interval(stamps_of(recording.ticks), rough.moment, reach, /*longer=*/true);
    if (of_counts.unlike > std::max(least, of_reference.unlike)) return {of_counts.begin, Shown::in_counts};
  }
  if (of_reference.unlike > least) return {of_reference.end, Shown::in_reference};
  return {of_reference.unlike > 0.0 ? of_reference.end : rough.moment, Shown::nowhere};
}

/// Poses are so good that a few long pairs are enough for lengths; a clock shows in many short ones.
measurement::FitData in_short_pairs(const measurement::FitData& one, const Recording& recording) {
  if (recording.poses.empty()) return one;
  measurement::FitData fine{one.model, {}};
  const wheels::WheelTrack& track = one.model->track();
  for (const measurement::ReferenceMotion& m :
       measurement::reference_motions(recording, recording.poses.size()).motions)
    if (track.covers(m.begin, m.end))
      fine.pairs.push_back({{m.begin, m.end}, m.motion, Eigen::Matrix3d::Identity()});
  return fine;
}

/// The time that cannot be told to lie before the step or after it, s on the clock of the reference: from
/// `begin` on, before `end`.
struct Unclear {
  double begin = 0.0, end = 0.0;
};

/// Where a clock is set back, what came before the step and what came after it lie in between each other: as
/// long as the step is. The reference shows where that is when its own clock was set; when that of the counts
/// was, the moment is known as well as two pairs tell it.
Unclear unclear_about(const Place& place, double size) {
  if (place.shown == Shown::in_counts) return {place.moment, place.moment};
  if (size <= 0.0) return {place.moment + size, place.moment};
  if (place.shown == Shown::in_reference) return {place.moment, place.moment};
  return {place.moment - settings::kMomentReach_s - size, place.moment + settings::kMomentReach_s + size};
}

/// Puts what comes after the step on the clock of what comes before it. Whatever the step, each sample stays
/// later than the one before it: one that would not is left out.
template <typename Sample>
void move(std::vector<Sample>& samples, const Unclear& unclear, double size) {
  std::erase_if(samples, [&](const Sample& s) { return s.t >= unclear.begin && s.t < unclear.end; });
  for (Sample& sample : samples)
    if (sample.t >= unclear.end) sample.t -= size;
  double newest = -std::numeric_limits<double>::infinity();
  std::erase_if(samples,
                [&](const Sample& s) { return s.t <= std::exchange(newest, std::max(newest, s.t)); });
}

/// Counts whose own clock was set back: the way through what is unclear is not known.
void interrupt(std::vector<TickSample>& ticks, const Unclear& unclear, double size) {
  const double end = unclear.end - size;
  std::erase_if(ticks, [&](const TickSample& s) { return s.t >= unclear.begin && s.t < end; });
  for (TickSample& tick : ticks)
    if (tick.t >= end) ++tick.segment;
}

void put_on_one_clock(Recording& recording, const Place& place, double size) {
  const Unclear unclear = unclear_about(place, size);
  move(recording.scans, unclear, size);
  move(recording.poses, unclear, size);
  if (size > 0.0 && place.shown == Shown::nowhere) interrupt(recording.ticks, unclear, size);
}

}  // namespace

std::optional<ClockStep> clock_step(const measurement::FitData& one) {
  if (one.pairs.size() < 2 * settings::kFewestPairsOfClock) return std::nullopt;
  const std::vector<double> delays = grid(0.0, settings::kSplitReach_s, settings::kSplitStep_s);
  Costs costs(one, delays);
  const std::vector<std::size_t> none(one.pairs.size(), delays.size() / 2);
  const Eigen::Vector2d gains = costs.gains(none);
  costs.weigh(gains, costs.noise(none, gains));
  const Split split = settled_split(costs);
  // A delay at the end of the search may lie anywhere beyond it.
  for (const std::size_t found : {split.before, split.after})
    if (found == 0 || found + 1 == delays.size()) return std::nullopt;
  const double size = costs.delay(split.after) - costs.delay(split.before);
  if (std::abs(size) < settings::kClocksApart_s) return std::nullopt;
  if (costs.best(0, costs.pairs()).cost - split.cost < settings::kPlainSplit) return std::nullopt;
  if (best_drift(costs, delays.size()) - split.cost < settings::kSplitNotDrift) return std::nullopt;
  const double fine = fine_delay(one, split.pair, one.pairs.size(), costs.delay(split.after)) -
                      fine_delay(one, 0, split.pair, costs.delay(split.before));
  return ClockStep{one.pairs[split.pair].interval.begin, fine};
}

measurement::Dataset without_clock_steps(measurement::Dataset rough) {
  if (rough.has_motions_alone()) return rough;
  ingest::Repairs repairs(rough.recordings.view());
  for (std::size_t i = 0; i < rough.data.size(); ++i) {
    auto step = clock_step(in_short_pairs(rough.data[i], rough.recordings[i]));
    if (!step) continue;
    Recording& recording = repairs.own(i);
    const Place place = place_of(recording, *step);
    put_on_one_clock(recording, place, step->size);
    const std::string when = place.shown == Shown::nowhere ? "about " + math::fixed(place.moment, 0)
                                                           : math::significant(place.moment, 12);
    recording.repairs.push_back(repaired_clock(many_of(ingest::reference_of(recording)), step->size, when,
                                               "counts", "one of the two clocks was set"));
  }
  if (!repairs.any()) return rough;
  auto opened = measurement::open_dataset(std::move(repairs).take(rough.recordings.stamps()));
  return opened ? measurement::measured_roughly(std::move(opened).value()) : rough;
}

}  // namespace odomcalib::calib::estimation
