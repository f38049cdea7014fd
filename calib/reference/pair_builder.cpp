#include "calib/reference/pair_builder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/matching/both_ways.hpp"
#include "calib/reference/scan_surfaces.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kPoseNoise = 5e-4;      ///< m, motion capture or localiser; scaled by the fit
constexpr double kPoseYawNoise = 1e-3;   ///< rad
constexpr double kTupleNoise = 1e-3;     ///< m, a scan match whose covariance is not recorded
constexpr double kTupleYawNoise = 2e-3;  ///< rad

bool is_keyframe(const Pose& step, double elapsed, const PairOptions& options) {
  const double travel = std::hypot(step.x, step.y);
  const double turn = std::abs(step.yaw);
  if (travel >= options.distance || turn >= options.rotation) return true;
  return elapsed >= options.duration && (travel > 1e-3 || turn > 1e-3);
}

Eigen::Matrix3d diagonal_covariance(double position, double yaw) {
  return Eigen::Vector3d(position * position, position * position, yaw * yaw).asDiagonal();
}

/// Chooses keyframes among instants with known odometry: the first, each that moved far enough, and the last.
std::vector<std::size_t> choose_keyframes(const std::vector<double>& times, const std::vector<Pose>& odometry,
                                          const PairOptions& options) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < times.size(); ++k)
    if (chosen.empty() ||
        is_keyframe(between(odometry[chosen.back()], odometry[k]), times[k] - times[chosen.back()], options))
      chosen.push_back(k);
  if (!chosen.empty() && chosen.back() + 1 < times.size()) chosen.push_back(times.size() - 1);
  return chosen;
}

PairSet pairs_from_increments(const Recording& recording) {
  PairSet set;
  double t = 0.0;
  for (const IncrementSample& sample : recording.increments) {
    SensorPair pair;
    pair.interval = {t, t + sample.duration};
    pair.motion = {sample.lidar_motion[0], sample.lidar_motion[1], sample.lidar_motion[2]};
    pair.covariance = diagonal_covariance(kTupleNoise, kTupleYawNoise);
    pair.follows_previous = t > 0.0;
    set.pairs.push_back(pair);
    t += sample.duration;
  }
  return set;
}

PairSet pairs_from_poses(const Recording& recording, const DriveModel& model,
                         std::span<const double> parameters, const EffectList& effects,
                         const PairOptions& options) {
  PairSet set;
  std::vector<double> times;
  for (const PoseSample& pose : recording.poses) times.push_back(pose.t);
  const auto keyframes =
      choose_keyframes(times, poses_at(model.trajectory(parameters, effects), times), options);
  bool linked = false;
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const PoseSample& a = recording.poses[keyframes[k]];
    const PoseSample& b = recording.poses[keyframes[k + 1]];
    const bool interrupted = has_gap(times, keyframes[k], keyframes[k + 1]);
    if (interrupted || !model.track().covers(a.t, b.t)) {
      ++set.rejected[interrupted ? "reference interrupted" : "no ticks"];
      linked = false;
      continue;
    }
    SensorPair pair;
    pair.interval = {a.t, b.t};
    pair.motion = between(Pose{a.x, a.y, a.yaw}, Pose{b.x, b.y, b.yaw});
    pair.motion.yaw = wrap_angle(pair.motion.yaw);
    pair.covariance = diagonal_covariance(kPoseNoise, kPoseYawNoise);
    pair.follows_previous = linked;
    linked = true;
    set.pairs.push_back(pair);
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
    auto reference = std::make_unique<MatchReference>(scans_.surface(keyframes[0]), set_.range_noise);
    bool linked = false;
    for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
      auto next = std::make_unique<MatchReference>(scans_.surface(keyframes[k + 1]), set_.range_noise);
      linked = add_pair(*reference, *next, keyframes[k], keyframes[k + 1], linked);
      reference = std::move(next);
    }
  }

 private:
  bool add_pair(const MatchReference& reference, const MatchReference& scan, std::size_t from, std::size_t to,
                bool linked) {
    if (const char* reason = scans_.gap_between(from, to)) return reject(reason);
    MatchOptions match;
    match.range_noise = set_.range_noise;
    match.min_overlap = options_.min_overlap;
    const Pose guess = scans_.guess(from, to);
    const MatchResult result = options_.rough ? match_point_to_line(reference, scan.surface(), guess, match)
                                              : match_both_ways(reference, scan, guess, match);
    if (!result.is_usable()) {
      ++set_.unmatched;
      return reject("match: " + to_string(result.status));
    }
    const Interval interval{scans_.times()[from], scans_.times()[to]};
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

PairSet build_pairs(const Recording& recording, const DriveModel& model, std::span<const double> parameters,
                    const EffectList& effects, const PairOptions& options) {
  if (!recording.increments.empty()) return pairs_from_increments(recording);
  if (!recording.poses.empty())
    return pairs_from_poses(recording, model, parameters, effects, pose_pair_options());
  PairSet set;
  set.range_noise = estimate_range_noise(recording.scans);
  const ScanSurfaces scans(recording, model, parameters, effects, set.range_noise);
  ScanChain(scans, options, set).run();
  return set;
}

}  // namespace odomcalib::calib
