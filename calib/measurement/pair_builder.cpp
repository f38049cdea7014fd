#include "calib/measurement/pair_builder.hpp"

#include <algorithm>
#include <cmath>

#include "calib/ingest/even_stamps.hpp"
#include "calib/matching/both_ways.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/placed_scan.hpp"
#include "calib/measurement/scan_surfaces.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

bool is_keyframe(const math::Pose& step, double elapsed, const PairOptions& options) {
  const double travel = std::hypot(step.x, step.y);
  const double turn = std::abs(step.yaw);
  if (travel >= options.distance || turn >= options.rotation) return true;
  return elapsed >= options.duration && (travel > settings::kTurnedAtAll || turn > settings::kTurnedAtAll);
}

/// Information of a guess that a match is held to.
Eigen::Matrix3d held_guess() {
  constexpr double kPlace = 1.0 / (settings::kHeldGuess_m * settings::kHeldGuess_m);
  constexpr double kTurn = 1.0 / (settings::kHeldGuess_rad * settings::kHeldGuess_rad);
  return Eigen::Vector3d(kPlace, kPlace, kTurn).asDiagonal();
}

Eigen::Matrix3d diagonal_covariance(double position, double yaw) {
  return Eigen::Vector3d(position * position, position * position, yaw * yaw).asDiagonal();
}

/// Chooses keyframes among instants with known odometry: the first, each that moved far enough, and the last.
std::vector<std::size_t> choose_keyframes(const std::vector<double>& times,
                                          const std::vector<math::Pose>& odometry,
                                          const PairOptions& options) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < times.size(); ++k)
    if (chosen.empty() ||
        is_keyframe(between(odometry[chosen.back()], odometry[k]), times[k] - times[chosen.back()], options))
      chosen.push_back(k);
  if (!chosen.empty() && chosen.back() + 1 < times.size()) chosen.push_back(times.size() - 1);
  return chosen;
}

/// Why a motion by so much is no measurement; null when it is one.
const char* ambiguity_of(double turn) {
  return std::abs(turn) > settings::kMostTurn_rad ? "turned by nearly half a turn or more" : nullptr;
}

PairSet pairs_from_increments(const Recording& recording) {
  PairSet set;
  double t = 0.0;
  bool linked = false;
  for (const IncrementSample& sample : recording.increments) {
    SensorPair pair;
    pair.interval = {t, t + sample.duration};
    t += sample.duration;
    if (const char* reason = ambiguity_of(sample.lidar_motion[2])) {
      ++set.rejected[reason];
      linked = false;
      continue;
    }
    pair.motion = {sample.lidar_motion[0], sample.lidar_motion[1], sample.lidar_motion[2]};
    pair.covariance = diagonal_covariance(settings::kTupleNoise_m, settings::kTupleNoise_rad);
    pair.follows_previous = linked;
    set.pairs.push_back(pair);
    linked = true;
  }
  return set;
}

/// s to either side of a keyframe in which poses stand for it: enough of them to average their noise away,
/// over no more time than wheels carry them well.
double reach_of_keyframes(const std::vector<PlacedScan>& places) {
  if (places.size() < 2) return 0.0;
  std::vector<double> steps;
  for (std::size_t k = 1; k < places.size(); ++k) steps.push_back(places[k].time - places[k - 1].time);
  const double wanted = places.front().covariance(0, 0) / (settings::kGoodMatch_m * settings::kGoodMatch_m);
  return std::min(0.5 * wanted * math::median_of(std::move(steps)), kMeanReach);
}

/// Means of the poses about each keyframe; none stands for two of them.
std::vector<PlacedScan> places_of_keyframes(const std::vector<PlacedScan>& places,
                                            const std::vector<std::size_t>& keyframes, double reach,
                                            const PathOfWheels& wheels) {
  std::vector<PlacedScan> means;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const double time = places[keyframes[k]].time;
    double own = reach;
    if (k > 0) own = std::min(own, 0.5 * (time - places[keyframes[k - 1]].time));
    if (k + 1 < keyframes.size()) own = std::min(own, 0.5 * (places[keyframes[k + 1]].time - time));
    means.push_back(mean_place(places, time, wheels, own).value_or(places[keyframes[k]]));
  }
  return means;
}

PairSet pairs_from_poses(const Recording& recording, const vehicle::DriveModel& model,
                         std::span<const double> parameters, const vehicle::EffectList& effects) {
  PairSet set;
  const vehicle::Trajectory trajectory = model.trajectory(parameters, effects);
  const PathOfWheels wheels = path_of_wheels(trajectory);
  const std::vector<PlacedScan> places = placed_poses(recording.poses, wheels);
  std::vector<double> times;
  times.reserve(places.size());
  for (const PlacedScan& place : places) times.push_back(place.time);
  const auto keyframes = choose_keyframes(times, poses_at(trajectory, times), pose_pair_options());
  const auto means = places_of_keyframes(places, keyframes, reach_of_keyframes(places), wheels);
  bool linked = false;
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const vehicle::Interval interval{times[keyframes[k]], times[keyframes[k + 1]]};
    const double turn = trajectory.at(interval.end).yaw - trajectory.at(interval.begin).yaw;
    const char* reason = ambiguity_of(turn);
    if (!model.track().covers(interval.begin, interval.end)) reason = "no counts at that time";
    if (ingest::has_gap(times, keyframes[k], keyframes[k + 1])) reason = "reference interrupted";
    if (reason != nullptr) {
      ++set.rejected[reason];
      linked = false;
      continue;
    }
    const auto [motion, covariance] = motion_between(means[k], means[k + 1]);
    set.pairs.push_back({interval, motion, covariance, linked});
    linked = true;
  }
  return set;
}

/// The information of a match without what it says along its weak direction: of the translation once yaw is
/// eliminated (Schur complement), the part across that direction is left, and the deviation of an open
/// direction takes the place of the rest.
Eigen::Matrix3d opened(const Eigen::Matrix3d& information, const Eigen::Vector2d& weak) {
  constexpr double kOpen = 1.0 / (settings::kOpenDirection_m * settings::kOpenDirection_m);
  const Eigen::Vector2d with_yaw = information.topRightCorner<2, 1>();
  const Eigen::Matrix2d by_yaw = with_yaw * with_yaw.transpose() / information(2, 2);
  const Eigen::Vector2d strong = math::quarter_turn(weak);
  const double across = strong.dot((information.topLeftCorner<2, 2>() - by_yaw) * strong);
  Eigen::Matrix3d opened = information;
  opened.topLeftCorner<2, 2>() =
      across * strong * strong.transpose() + kOpen * weak * weak.transpose() + by_yaw;
  return opened;
}

/// The motion of a match as it would be had it not slid along its weak direction, and turned with it.
math::Pose slid_back(const matching::MatchResult& match, const math::Pose& guess) {
  const Eigen::Vector2d& weak = match.weak_direction;
  const double slid = weak.dot(Eigen::Vector2d(match.motion.x - guess.x, match.motion.y - guess.y));
  const double turn = match.information.bottomLeftCorner<1, 2>().dot(weak) / match.information(2, 2);
  return {match.motion.x - slid * weak.x(), match.motion.y - slid * weak.y(), match.motion.yaw + slid * turn};
}

/// Whether what a match says across its weak direction is a measurement.
bool is_sound_part(const matching::MatchResult& match) {
  return match.is_partial() && match.residual < settings::kMostScatterOfPart;
}

SensorPair partial_pair(const vehicle::Interval& interval, const matching::MatchResult& match,
                        const math::Pose& guess) {
  SensorPair pair;
  pair.interval = interval;
  pair.motion = slid_back(match, guess);
  pair.covariance = math::inverse_symmetric(opened(match.information, match.weak_direction));
  pair.is_partial = true;
  return pair;
}

/// m, of a motion.
/// @param open direction that does not count; zero where all do
double size_of(const math::Pose& motion, const Eigen::Vector2d& open) {
  const Eigen::Vector2d way(motion.x, motion.y);
  return std::hypot((way - open * open.dot(way)).norm(), settings::kStoodArm_m * motion.yaw);
}

/// By how much ways by the nominal wheels are longer than by those of a fit that may have taken standing for
/// small wheels.
double nominal_stretch(const RobotDescription& robot, std::span<const double> parameters) {
  const wheels::BaseParameters fitted = vehicle::to_base(parameters);
  const double nominal = 0.5 * (robot.left_wheel_diameter + robot.right_wheel_diameter);
  const double stretch = nominal / (fitted.left_radius + fitted.right_radius);
  return stretch > 1.0 ? stretch : 1.0;
}

bool has_stood(const math::Pose& rolled, const math::Pose& seen, const Eigen::Vector2d& open) {
  const double way = size_of(rolled, open);
  return way > settings::kStoodRolled_m && size_of(seen, open) < settings::kStoodShare * way;
}

/// Leaves out pairs in which the robot pushes against something: they say nothing of the lengths.
/// @param stood one for each pair
void leave_out_standing(const std::vector<bool>& stood, PairSet& set) {
  std::vector<SensorPair> left;
  for (std::size_t first = 0; first < stood.size();) {
    std::size_t end = first + 1;
    while (end < stood.size() && stood[end] == stood[first]) ++end;
    if (stood[first] && end - first >= settings::kStoodInARow)
      set.stood += end - first;
    else
      left.insert(left.end(), set.pairs.begin() + static_cast<std::ptrdiff_t>(first),
                  set.pairs.begin() + static_cast<std::ptrdiff_t>(end));
    if (!left.empty() && end < stood.size() && left.back().interval.end != set.pairs[end].interval.begin)
      set.pairs[end].follows_previous = false;
    first = end;
  }
  if (set.stood == 0) return;
  set.rejected["the wheels turned and the robot stood"] = set.stood;
  set.pairs = std::move(left);
  set.partial = static_cast<std::size_t>(std::count_if(
      set.pairs.begin(), set.pairs.end(), [](const SensorPair& pair) { return pair.is_partial; }));
}

enum class Wanted {
  whole_motions,
  all_that_is_seen,  ///< also motions of which one direction stays open
};

/// Matches keyframe scans one after the other; every scan's surface is made once.
class ScanChain {
 public:
  /// @param stretch of the ways by guess, that makes them those of the nominal wheels
  ScanChain(const ScanSurfaces& scans, const PairOptions& options, Wanted wanted, double stretch,
            PairSet& set)
      : scans_(scans), options_(options), wanted_(wanted), stretch_(stretch), set_(set) {}

  void run() {
    const auto keyframes = choose_keyframes(scans_.times(), scans_.odometry(), options_);
    if (keyframes.empty()) return;
    auto reference =
        std::make_unique<matching::MatchReference>(scans_.surface(keyframes[0]), set_.range_noise);
    bool linked = false;
    for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
      auto next =
          std::make_unique<matching::MatchReference>(scans_.surface(keyframes[k + 1]), set_.range_noise);
      linked = add_pair(*reference, *next, keyframes[k], keyframes[k + 1], linked);
      reference = std::move(next);
    }
    if (wanted_ == Wanted::all_that_is_seen) leave_out_standing(stood_, set_);
  }

 private:
  bool add_pair(const matching::MatchReference& reference, const matching::MatchReference& scan,
                std::size_t from, std::size_t to, bool linked) {
    if (const char* reason = scans_.gap_between(from, to)) return reject(reason);
    matching::MatchOptions match;
    match.range_noise = set_.range_noise;
    match.min_overlap = options_.min_overlap;
    const math::Pose guess = scans_.guess(from, to);
    if (const char* reason = ambiguity_of(guess.yaw)) return reject(reason);
    const vehicle::Interval interval{scans_.times()[from], scans_.times()[to]};
    matching::MatchResult result = matched(reference, scan, guess, match);
    if (!result.is_usable() && wanted_ == Wanted::all_that_is_seen) {
      result = matched_in_part(reference, scan, guess, match);
      if (is_sound_part(result)) {
        // Its errors are not those of its neighbours: they open other directions.
        set_.pairs.push_back(partial_pair(interval, result, guess));
        stood_.push_back(has_stood(rolled(guess), result.motion, result.weak_direction));
        ++set_.partial;
        return false;
      }
    }
    if (!result.is_usable()) {
      ++set_.unmatched;
      return reject("match: " + to_string(result.status));
    }
    set_.pairs.push_back({interval, result.motion, result.covariance, linked});
    stood_.push_back(has_stood(rolled(guess), result.motion, Eigen::Vector2d::Zero()));
    return true;
  }

  [[nodiscard]] matching::MatchResult matched(const matching::MatchReference& reference,
                                              const matching::MatchReference& scan, const math::Pose& guess,
                                              const matching::MatchOptions& match) const {
    return options_.rough ? match_point_to_line(reference, scan.surface(), guess, match)
                          : match_both_ways(reference, scan, guess, match);
  }

  bool reject(const std::string& reason) {
    ++set_.rejected[reason];
    return false;
  }

  [[nodiscard]] math::Pose rolled(const math::Pose& guess) const {
    return {stretch_ * guess.x, stretch_ * guess.y, guess.yaw};
  }

  /// Held to the guess, lest the scan slides where nothing stops it; or, where it does not fit there, from
  /// rest: of a robot that stands although its wheels turn, the guess is far off.
  [[nodiscard]] matching::MatchResult matched_in_part(const matching::MatchReference& reference,
                                                      const matching::MatchReference& scan,
                                                      const math::Pose& guess,
                                                      matching::MatchOptions match) const {
    match.wants_part = true;
    match.guess_information = held_guess();
    matching::MatchResult held = matched(reference, scan, guess, match);
    if (held.status != matching::MatchStatus::no_overlap) return held;
    match.guess_information.setZero();
    return matched(reference, scan, {}, match);
  }

  const ScanSurfaces& scans_;
  const PairOptions& options_;
  Wanted wanted_;
  double stretch_;
  PairSet& set_;
  std::vector<bool> stood_;  ///< one for each pair
};

std::size_t median_of_counts(std::vector<double> counts) {
  return counts.empty() ? 0 : static_cast<std::size_t>(math::median_of(std::move(counts)));
}

/// Readings and beams of a scan, medians over all.
void count_readings(std::span<const Scan> scans, PairSet& set) {
  std::vector<double> readings, beams;
  for (const Scan& scan : scans) {
    std::size_t usable = 0;
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam)
      if (matching::is_usable(scan, beam)) ++usable;
    readings.push_back(static_cast<double>(usable));
    beams.push_back(static_cast<double>(scan.ranges.size()));
  }
  set.readings = median_of_counts(std::move(readings));
  set.beams = median_of_counts(std::move(beams));
}

/// The keyframes of a recording's scans, matched.
PairSet pairs_of_scans(const Recording& recording, const ScanSurfaces& scans, const PairOptions& options,
                       double stretch, Wanted wanted) {
  PairSet set;
  set.range_noise = scans.range_noise();
  count_readings(recording.scans, set);
  ScanChain(scans, options, wanted, stretch, set).run();
  return set;
}

bool has_few_whole_pairs(const PairSet& set) {
  const auto whole = static_cast<double>(set.pairs.size());
  return set.unmatched > 0 && whole < settings::kFewWholePairs * (whole + static_cast<double>(set.unmatched));
}

}  // namespace

PairSet build_pairs(const Recording& recording, const vehicle::DriveModel& model,
                    std::span<const double> parameters, const vehicle::EffectList& effects,
                    const PairOptions& options) {
  if (!recording.increments.empty()) return pairs_from_increments(recording);
  if (!recording.poses.empty()) return pairs_from_poses(recording, model, parameters, effects);
  const ScanSurfaces scans(recording, model, parameters, effects,
                           matching::estimate_range_noise(recording.scans));
  const double stretch = nominal_stretch(recording.robot, parameters);
  PairSet whole = pairs_of_scans(recording, scans, options, stretch, Wanted::whole_motions);
  if (!has_few_whole_pairs(whole)) return whole;
  return pairs_of_scans(recording, scans, options, stretch, Wanted::all_that_is_seen);
}

}  // namespace odomcalib::calib::measurement
