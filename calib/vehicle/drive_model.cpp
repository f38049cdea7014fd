#include "calib/vehicle/drive_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "calib/math/last_value.hpp"
#include "calib/vehicle/pose_sum.hpp"
#include "calib/vehicle/settings.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/vehicle/step_twist.hpp"

namespace odomcalib::calib::vehicle {
namespace {

math::Pose pose_at(const wheels::WheelTrack& track, const std::vector<math::Pose>& poses,
                   const std::vector<math::Pose>& twists, double time) {
  const std::size_t k = track.interval_at(time);
  const double share = (time - track.t[k]) / (track.t[k + 1] - track.t[k]);
  const math::Pose w = PartOfStep(track, twists, k).twist(share);
  return compose(poses[k], math::exp_se2(w.x, w.y, w.yaw));
}

}  // namespace

Eigen::VectorXd to_vector(const wheels::BaseParameters& base, std::size_t effect_parameters) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kBaseCount + effect_parameters));
  v.head<kBaseCount>() << base.left_radius, base.right_radius, base.track_width, base.mount.x, base.mount.y,
      base.mount.yaw;
  return v;
}

wheels::BaseParameters to_base(std::span<const double> p) {
  return {p[kLeftRadius], p[kRightRadius], p[kTrackWidth], math::Pose{p[kMountX], p[kMountY], p[kMountYaw]}};
}

std::size_t count_parameters(const EffectList& effects) {
  std::size_t count = 0;
  for (const auto& effect : effects) count += effect->parameters().size();
  return count;
}

DriveModel::DriveModel(wheels::WheelTrack track, DriveContext context)
    : track_(std::move(track)), context_(std::move(context)) {}

std::span<const StepContext> DriveModel::context_within(const Interval& interval) const {
  const std::size_t first = track_.interval_at(interval.begin);
  const std::size_t last = std::max(first, track_.interval_at(interval.end));
  return std::span(context_.intervals()).subspan(first, last - first + 1);
}

DriveModel DriveModel::located(wheels::WheelTrack track, std::span<const Fix> fixes,
                               std::span<const double> parameters, const EffectList& effects) {
  DriveContext context = make_context(track, to_base(parameters));
  DriveModel model(std::move(track), std::move(context));
  const Trajectory path = model.trajectory(parameters, effects);
  math::Pose origin;  // of dead reckoning, in the frame of the fixes
  std::size_t next = 0;
  for (std::size_t k = 0; k < model.context_.size(); ++k) {
    StepContext& c = model.context_[k];
    for (; next < fixes.size() && (next == 0 || path.encoder_time(fixes[next].time) <= model.track_.t[k]);
         ++next)
      origin = compose(fixes[next].pose, inverse(path.at(fixes[next].time)));
    const math::Pose here = compose(origin, path.poses_[k]);
    c.face(here.yaw + path.twists_[k].yaw / 2.0);
    c.x = here.x;
    c.y = here.y;
  }
  return model;
}

double Trajectory::encoder_time(double sensor_time) const {
  return sensor_time - effects_.delay<double>(sensor_time - middle_of(*track_), parameters_);
}

math::Pose Trajectory::at(double sensor_time) const {
  return pose_at(*track_, poses_, twists_, encoder_time(sensor_time));
}

Eigen::Vector3d sensor_velocity(const Trajectory& trajectory, const math::Pose& mount, double time) {
  const math::Pose a = compose(trajectory.at(time - settings::kVelocityReach_s), mount);
  const math::Pose b = compose(trajectory.at(time + settings::kVelocityReach_s), mount);
  return Eigen::Vector3d(b.x - a.x, b.y - a.y, b.yaw - a.yaw) / (2.0 * settings::kVelocityReach_s);
}

Trajectory DriveModel::trajectory(std::span<const double> parameters, const EffectList& effects) const {
  if (parameters.size() < kBaseCount + count_parameters(effects))
    throw std::invalid_argument("a trajectory needs the parameters of the base and of each effect");
  Trajectory trajectory;
  trajectory.track_ = &track_;
  trajectory.parameters_.assign(parameters.begin(), parameters.end());
  trajectory.effects_ = PlacedEffects(effects, kBaseCount);
  trajectory.poses_.resize(context_.size() + 1);
  trajectory.twists_.reserve(context_.size());
  PoseSum sum;
  for (std::size_t k = 0; k < context_.size(); ++k) {
    trajectory.twists_.push_back(twist_of(context_[k], parameters, trajectory.effects_));
    sum.add(trajectory.twists_.back());
    trajectory.poses_[k + 1] = sum.pose();
  }
  return trajectory;
}

std::vector<math::Pose> Trajectory::sensor_motions(std::span<const Interval> intervals) const {
  const math::Pose mount = to_base(parameters_).mount;
  std::vector<math::Pose> motions;
  motions.reserve(intervals.size());
  math::LastValue pose([this](double time) { return at(time); });
  for (const Interval& interval : intervals) {
    const math::Pose begin = pose(interval.begin);
    motions.push_back(conjugate(between(begin, pose(interval.end)), mount));
  }
  return motions;
}

std::vector<math::Pose> DriveModel::predict(std::span<const double> parameters, const EffectList& effects,
                                            std::span<const Interval> intervals) const {
  return trajectory(parameters, effects).sensor_motions(intervals);
}

}  // namespace odomcalib::calib::vehicle
