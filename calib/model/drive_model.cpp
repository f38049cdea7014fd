#include "calib/model/drive_model.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::calib {
namespace {

/// Base poses at the samples and the constant twist of each interval: enough to evaluate any time.
template <typename T>
struct Integrated {
  std::vector<Pose2<T>> poses;
  std::vector<Pose2<T>> twists;  ///< logarithms: x, y, yaw of the constant motion in each interval
};

template <typename T>
Pose2<T> twist_of(const StepContext& context, std::span<const T> parameters, const EffectList& effects) {
  WheelStep<T> step;
  step.left = parameters[kLeftRadius] * context.left_delta;
  step.right = parameters[kRightRadius] * context.right_delta;
  std::size_t offset = kBaseCount;
  for (const auto& effect : effects) {
    const std::size_t count = effect->parameters().size();
    effect->apply(context, parameters.subspan(offset, count), step);
    offset += count;
  }
  return {(step.left + step.right) / 2.0, step.side,
          (step.right - step.left) / (parameters[kTrackWidth] * step.track) + step.yaw};
}

template <typename T>
Integrated<T> integrate(const std::vector<StepContext>& context, std::span<const T> parameters,
                        const EffectList& effects) {
  Integrated<T> result;
  result.poses.resize(context.size() + 1);
  result.twists.reserve(context.size());
  for (std::size_t k = 0; k < context.size(); ++k) {
    result.twists.push_back(twist_of(context[k], parameters, effects));
    const Pose2<T>& w = result.twists.back();
    result.poses[k + 1] = compose(result.poses[k], exp_se2(w.x, w.y, w.yaw));
  }
  return result;
}

template <typename T>
T total_delay(double time, std::span<const T> parameters, const EffectList& effects) {
  T delay(0.0);
  std::size_t offset = kBaseCount;
  for (const auto& effect : effects) {
    const std::size_t count = effect->parameters().size();
    delay += effect->delay(time, parameters.subspan(offset, count));
    offset += count;
  }
  return delay;
}

/// Delays that change with time are counted from here, so that they do not look like a constant one.
double middle_of(const WheelTrack& track) { return (track.t.front() + track.t.back()) / 2.0; }

double value_of(double x) { return x; }
double value_of(const Jet& x) { return x.a; }

template <typename T>
Pose2<T> pose_at(const WheelTrack& track, const std::vector<Pose2<T>>& poses,
                 const std::vector<Pose2<T>>& twists, const T& time) {
  const std::size_t k = track.interval_at(value_of(time));
  const T share = (time - track.t[k]) / (track.t[k + 1] - track.t[k]);
  const Pose2<T>& w = twists[k];
  return compose(poses[k], exp_se2<T>(share * w.x, share * w.y, share * w.yaw));
}

template <typename T>
std::vector<Pose2<T>> predict_all(const WheelTrack& track, const std::vector<StepContext>& context,
                                  std::span<const T> parameters, const EffectList& effects,
                                  std::span<const Interval> intervals) {
  const Integrated<T> integrated = integrate(context, parameters, effects);
  const Pose2<T> mount{parameters[kMountX], parameters[kMountY], parameters[kMountYaw]};
  const double middle = middle_of(track);
  std::vector<Pose2<T>> motions;
  motions.reserve(intervals.size());
  for (const Interval& interval : intervals) {
    const T begin = interval.begin - total_delay(interval.begin - middle, parameters, effects);
    const T end = interval.end - total_delay(interval.end - middle, parameters, effects);
    const Pose2<T> base = between(pose_at(track, integrated.poses, integrated.twists, begin),
                                  pose_at(track, integrated.poses, integrated.twists, end));
    motions.push_back(conjugate(base, mount));
  }
  return motions;
}

/// Parameters as jets; those in [first, first + kJetSize) carry derivatives.
std::vector<Jet> seed(std::span<const double> parameters, std::size_t first) {
  std::vector<Jet> jets;
  jets.reserve(parameters.size());
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const bool active = k >= first && k < first + kJetSize;
    jets.push_back(active ? Jet(parameters[k], static_cast<int>(k - first)) : Jet(parameters[k]));
  }
  return jets;
}

void copy_derivatives(const std::vector<Pose2<Jet>>& motions, std::size_t first, std::size_t count,
                      Eigen::MatrixXd& jacobian) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Jet* rows[] = {&motions[i].x, &motions[i].y, &motions[i].yaw};
    for (int r = 0; r < 3; ++r)
      for (std::size_t k = 0; k < count; ++k)
        jacobian(static_cast<Eigen::Index>(3 * i) + r, static_cast<Eigen::Index>(first + k)) =
            rows[r]->v(static_cast<Eigen::Index>(k));
  }
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

Pose Trajectory::at(double sensor_time) const {
  const double delay = total_delay<double>(sensor_time - middle_of(*track_), parameters_, effects_);
  return pose_at<double>(*track_, poses_, twists_, sensor_time - delay);
}

Trajectory DriveModel::trajectory(std::span<const double> parameters, const EffectList& effects) const {
  Integrated<double> integrated = integrate<double>(context_, parameters, effects);
  Trajectory trajectory;
  trajectory.track_ = &track_;
  trajectory.poses_ = std::move(integrated.poses);
  trajectory.twists_ = std::move(integrated.twists);
  trajectory.parameters_.assign(parameters.begin(), parameters.end());
  trajectory.effects_ = effects;
  return trajectory;
}

std::vector<Pose> DriveModel::predict(std::span<const double> parameters, const EffectList& effects,
                                      std::span<const Interval> intervals) const {
  return predict_all<double>(track_, context_, parameters, effects, intervals);
}

std::vector<Pose> DriveModel::predict(std::span<const double> parameters, const EffectList& effects,
                                      std::span<const Interval> intervals, Eigen::MatrixXd& jacobian,
                                      std::size_t first) const {
  jacobian.resize(static_cast<Eigen::Index>(3 * intervals.size()),
                  static_cast<Eigen::Index>(parameters.size() - first));
  std::vector<Pose> values;
  for (std::size_t chunk = first; chunk < parameters.size(); chunk += kJetSize) {
    const std::vector<Jet> jets = seed(parameters, chunk);
    const auto motions = predict_all<Jet>(track_, context_, jets, effects, intervals);
    copy_derivatives(motions, chunk - first, std::min<std::size_t>(kJetSize, parameters.size() - chunk),
                     jacobian);
    if (chunk > first) continue;
    values.reserve(motions.size());
    for (const auto& m : motions) values.push_back({m.x.a, m.y.a, m.yaw.a});
  }
  return values;
}

}  // namespace odomcalib::calib
