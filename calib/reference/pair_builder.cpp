#include "calib/reference/pair_builder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/matching/point_to_line.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kPoseNoise = 5e-4;      ///< m, motion capture or localiser; scaled by the fit
constexpr double kPoseYawNoise = 1e-3;   ///< rad
constexpr double kTupleNoise = 1e-3;     ///< m, a scan match whose covariance is not recorded
constexpr double kTupleYawNoise = 2e-3;  ///< rad
constexpr double kMaxGap =
    2.0;  ///< s between neighbouring scans or poses; beyond, the reference was interrupted

std::vector<Pose> poses_at(const Trajectory& odometry, const std::vector<double>& times) {
  std::vector<Pose> poses;
  poses.reserve(times.size());
  for (const double t : times) poses.push_back(odometry.at(t));
  return poses;
}

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

bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k)
    if (times[k + 1] - times[k] > kMaxGap) return true;
  return false;
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
  ScanChain(const Recording& recording, const DriveModel& model, std::span<const double> parameters,
            const EffectList& effects, const PairOptions& options, PairSet& set)
      : recording_(recording),
        model_(model),
        options_(options),
        mount_(to_base(parameters).mount),
        set_(set),
        trajectory_(model.trajectory(parameters, effects)) {}

  void run() {
    for (const Scan& scan : recording_.scans) times_.push_back(scan.t + reference_time(scan));
    odometry_ = poses_at(trajectory_, times_);
    const auto keyframes = choose_keyframes(times_, odometry_, options_);
    if (keyframes.empty()) return;
    auto reference = std::make_unique<MatchReference>(surface(keyframes[0]), set_.range_noise);
    bool linked = false;
    for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
      Surface next = surface(keyframes[k + 1]);
      linked = add_pair(*reference, next, keyframes[k], keyframes[k + 1], linked);
      reference = std::make_unique<MatchReference>(std::move(next), set_.range_noise);
    }
  }

 private:
  [[nodiscard]] Surface surface(std::size_t index) const {
    const Scan& scan = recording_.scans[index];
    const BeamMotion motion = beam_motion(scan);
    return make_surface(scan, motion, set_.range_noise);
  }

  /// Sensor motion inside the sweep from its middle, interpolated between three odometry poses.
  [[nodiscard]] BeamMotion beam_motion(const Scan& scan) const {
    const double middle = reference_time(scan);
    if (!(middle > 0.0)) return [](double) { return Pose{}; };
    const Pose base = trajectory_.at(scan.t + middle);
    const Pose before = log_se2(conjugate(between(base, trajectory_.at(scan.t)), mount_));
    const Pose after = log_se2(conjugate(between(base, trajectory_.at(scan.t + 2.0 * middle)), mount_));
    return [=](double seconds) {
      const double share = (seconds - middle) / middle;
      const Pose& w = share < 0.0 ? before : after;
      const double f = std::abs(share);
      return exp_se2(f * w.x, f * w.y, f * w.yaw);
    };
  }

  bool add_pair(const MatchReference& reference, const Surface& scan, std::size_t from, std::size_t to,
                bool linked) {
    const Interval interval{times_[from], times_[to]};
    if (has_gap(times_, from, to)) return reject("reference interrupted");
    if (!model_.track().covers(interval.begin, interval.end)) return reject("no ticks");
    MatchOptions match;
    match.range_noise = set_.range_noise;
    match.min_overlap = options_.min_overlap;
    const Pose base = between(odometry_[from], odometry_[to]);
    const MatchResult result = match_point_to_line(reference, scan, conjugate(base, mount_), match);
    if (!result.is_usable()) return reject("match: " + to_string(result.status));
    set_.pairs.push_back({interval, result.motion, result.covariance, linked});
    return true;
  }

  bool reject(const std::string& reason) {
    ++set_.rejected[reason];
    return false;
  }

  const Recording& recording_;
  const DriveModel& model_;
  const PairOptions& options_;
  Pose mount_;
  PairSet& set_;
  Trajectory trajectory_;
  std::vector<double> times_;   ///< reference time of each scan
  std::vector<Pose> odometry_;  ///< base pose by odometry at those times
};

}  // namespace

PairSet build_pairs(const Recording& recording, const DriveModel& model, std::span<const double> parameters,
                    const EffectList& effects, const PairOptions& options) {
  if (!recording.increments.empty()) return pairs_from_increments(recording);
  if (!recording.poses.empty())
    return pairs_from_poses(recording, model, parameters, effects, pose_pair_options());
  PairSet set;
  set.range_noise = estimate_range_noise(recording.scans);
  ScanChain(recording, model, parameters, effects, options, set).run();
  return set;
}

}  // namespace odomcalib::calib
