#include "calib/model/drive_model.hpp"

#include "calib/model/sensitivity.hpp"
#include "calib/model/step_twist.hpp"

namespace odomcalib::calib {
namespace {

/// Base poses at the samples and the constant twist of each interval: enough to evaluate any time.
struct Integrated {
  std::vector<Pose> poses;
  std::vector<Pose> twists;
};

Integrated integrate(const std::vector<StepContext>& context, std::span<const double> parameters,
                     const EffectList& effects) {
  const PlacedEffects placed(effects, kBaseCount);
  Integrated result;
  result.poses.resize(context.size() + 1);
  result.twists.reserve(context.size());
  for (std::size_t k = 0; k < context.size(); ++k) {
    result.twists.push_back(twist_of(context[k], parameters, placed));
    const Pose& w = result.twists.back();
    result.poses[k + 1] = compose(result.poses[k], exp_se2(w.x, w.y, w.yaw));
  }
  return result;
}

Pose pose_at(const WheelTrack& track, const std::vector<Pose>& poses, const std::vector<Pose>& twists,
             double time) {
  const std::size_t k = track.interval_at(time);
  const double share = (time - track.t[k]) / (track.t[k + 1] - track.t[k]);
  const Pose& w = twists[k];
  return compose(poses[k], exp_se2(share * w.x, share * w.y, share * w.yaw));
}

std::vector<Pose> motions_of(const WheelTrack& track, const Integrated& integrated,
                             std::span<const double> parameters, const EffectList& effects,
                             std::span<const Interval> intervals) {
  const Pose mount = to_base(parameters).mount;
  const double middle = middle_of(track);
  const PlacedEffects placed(effects, kBaseCount);
  const auto at = [&](double time) {
    const double delay = placed.delay(time - middle, parameters);
    return pose_at(track, integrated.poses, integrated.twists, time - delay);
  };
  std::vector<Pose> motions;
  motions.reserve(intervals.size());
  for (const Interval& interval : intervals)
    motions.push_back(conjugate(between(at(interval.begin), at(interval.end)), mount));
  return motions;
}

}  // namespace

Eigen::VectorXd to_vector(const BaseParameters& base, std::size_t effect_parameters) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kBaseCount + effect_parameters));
  v.head<kBaseCount>() << base.left_radius, base.right_radius, base.track_width, base.mount.x, base.mount.y,
      base.mount.yaw;
  return v;
}

BaseParameters to_base(std::span<const double> p) {
  return {p[kLeftRadius], p[kRightRadius], p[kTrackWidth], Pose{p[kMountX], p[kMountY], p[kMountYaw]}};
}

std::size_t count_parameters(const EffectList& effects) {
  std::size_t count = 0;
  for (const auto& effect : effects) count += effect->parameters().size();
  return count;
}

DriveModel::DriveModel(WheelTrack track, std::vector<StepContext> context)
    : track_(std::move(track)), context_(std::move(context)) {}

void DriveModel::locate(std::span<const Fix> fixes, std::span<const double> parameters,
                        const EffectList& effects) {
  const Trajectory path = trajectory(parameters, effects);
  Pose origin;  // of dead reckoning, in the frame of the fixes
  std::size_t next = 0;
  for (std::size_t k = 0; k < context_.size(); ++k) {
    StepContext& c = context_[k];
    for (; next < fixes.size() && (next == 0 || path.encoder_time(fixes[next].time) <= track_.t[k]); ++next)
      origin = compose(fixes[next].pose, inverse(path.at(fixes[next].time)));
    const Pose here = compose(origin, path.poses_[k]);
    c.heading = here.yaw + path.twists_[k].yaw / 2.0;
    c.x = here.x;
    c.y = here.y;
  }
}

double Trajectory::encoder_time(double sensor_time) const {
  return sensor_time - effects_.delay<double>(sensor_time - middle_of(*track_), parameters_);
}

Pose Trajectory::at(double sensor_time) const {
  return pose_at(*track_, poses_, twists_, encoder_time(sensor_time));
}

Eigen::Vector3d sensor_velocity(const Trajectory& trajectory, const Pose& mount, double time) {
  constexpr double kHalf = 0.02;
  const Pose a = compose(trajectory.at(time - kHalf), mount);
  const Pose b = compose(trajectory.at(time + kHalf), mount);
  return Eigen::Vector3d(b.x - a.x, b.y - a.y, b.yaw - a.yaw) / (2.0 * kHalf);
}

Trajectory DriveModel::trajectory(std::span<const double> parameters, const EffectList& effects) const {
  Integrated integrated = integrate(context_, parameters, effects);
  Trajectory trajectory;
  trajectory.track_ = &track_;
  trajectory.poses_ = std::move(integrated.poses);
  trajectory.twists_ = std::move(integrated.twists);
  trajectory.parameters_.assign(parameters.begin(), parameters.end());
  trajectory.effects_ = PlacedEffects(effects, kBaseCount);
  return trajectory;
}

std::vector<Pose> DriveModel::predict(std::span<const double> parameters, const EffectList& effects,
                                      std::span<const Interval> intervals) const {
  return motions_of(track_, integrate(context_, parameters, effects), parameters, effects, intervals);
}

std::vector<Pose> DriveModel::predict(std::span<const double> parameters, const EffectList& effects,
                                      std::span<const Interval> intervals, Eigen::MatrixXd& jacobian,
                                      std::size_t first) const {
  const Integrated integrated = integrate(context_, parameters, effects);
  const Linearisation at{track_, context_, integrated.poses, integrated.twists};
  jacobian = sensitivity(at, parameters, effects, intervals, first);
  return motions_of(track_, integrated, parameters, effects, intervals);
}

}  // namespace odomcalib::calib
