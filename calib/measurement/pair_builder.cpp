#include "calib/measurement/pair_builder.hpp"

#include <algorithm>
#include <cmath>

#include "calib/ingest/even_stamps.hpp"
#include "calib/matching/both_ways.hpp"
#include "calib/math/median.hpp"
#include "calib/measurement/placed_poses.hpp"
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
    if (!model.track().covers(interval.begin, interval.end)) reason = "no ticks";
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

/// Matches keyframe scans one after the other; every scan's surface is made once.
class ScanChain {
 public:
  ScanChain(const ScanSurfaces& scans, const PairOptions& options, PairSet& set)
      : scans_(scans), options_(options), set_(set) {}

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
    const matching::MatchResult result = options_.rough
                                             ? match_point_to_line(reference, scan.surface(), guess, match)
                                             : match_both_ways(reference, scan, guess, match);
    if (!result.is_usable()) {
      ++set_.unmatched;
      return reject("match: " + to_string(result.status));
    }
    const vehicle::Interval interval{scans_.times()[from], scans_.times()[to]};
    set_.pairs.push_back({interval, result.motion, result.covariance, linked});
    return true;
  }

  bool reject(const std::string& reason) {
    ++set_.rejected[reason];
    return false;
  }

  const ScanSurfaces& scans_;
  const PairOptions& options_;
  PairSet& set_;
};

}  // namespace

PairSet build_pairs(const Recording& recording, const vehicle::DriveModel& model,
                    std::span<const double> parameters, const vehicle::EffectList& effects,
                    const PairOptions& options) {
  if (!recording.increments.empty()) return pairs_from_increments(recording);
  if (!recording.poses.empty()) return pairs_from_poses(recording, model, parameters, effects);
  PairSet set;
  set.range_noise = matching::estimate_range_noise(recording.scans);
  const ScanSurfaces scans(recording, model, parameters, effects, set.range_noise);
  ScanChain(scans, options, set).run();
  return set;
}

}  // namespace odomcalib::calib::measurement
