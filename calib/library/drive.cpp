#include "calib/library/drive.hpp"

#include <odomcalib/odometry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/math/vector2.hpp"
#include "calib/odometry/correction.hpp"
#include "calib/terms/catalogue.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::calib::library {
namespace {

constexpr const char* kTimeOffset = "time_offset";

double metres_per_count_of(const RobotDescription& robot, const Calibration& calibration) {
  const double left =
      calibration.parameter(BaseQuantity::left_wheel_diameter).value_or(robot.left_wheel_diameter);
  const double right =
      calibration.parameter(BaseQuantity::right_wheel_diameter).value_or(robot.right_wheel_diameter);
  return std::max(left, right) * math::kPi / robot.ticks_per_rev;
}

/// The noise alone is certain to be zero where the file says nothing of it.
odometry::IncrementNoise noise_of(const Calibration& calibration) {
  return odometry::contact_noise_of(calibration).value_or(odometry::IncrementNoise{});
}

/// Value of one parameter of an effect in the file; zero where it does not have it.
double stated(const Calibration& calibration, const std::string& effect, const std::string& parameter) {
  for (const EffectResult& result : calibration.effects)
    for (const auto& [name, quantity] : result.parameters)
      if (result.name == effect && name == parameter) return quantity.value;
  return 0.0;
}

std::vector<terms::LidarFinding> lidar_findings(const Calibration& calibration) {
  std::vector<terms::LidarFinding> findings;
  for (const EffectResult& result : calibration.effects) {
    const auto effect = terms::find_lidar_effect(result.name);
    if (!effect || !effect->is_correctable()) continue;
    const std::vector<double> values = effect->values_of(result.parameters);
    if (!values.empty()) findings.push_back({effect, values, {}, 1.0, 0.0, 0.0});
  }
  return findings;
}

/// Where an effect of the reference is applied, and why the others are not.
EffectUse use_of_reference(const odometry::Placement& placement, EffectUse use) {
  const auto lidar = terms::find_lidar_effect(placement.effect);
  use.place = ODOMCALIB_LEFT_OUT;
  if (lidar && lidar->is_correctable())
    use.place = ODOMCALIB_IN_SCANS;
  else if (placement.effect == kTimeOffset)
    use.place = ODOMCALIB_IN_STAMPS;
  else if (lidar)
    use.why = "no scan shows it well enough to be corrected by it";
  else if (placement.effect == "clock_drift")
    use.why = "it counts from the middle of the drive that was calibrated with";
  else if (placement.effect == "scan_skew")
    use.why = "it bends scans that are taken while turning: beams need their times";
  else
    use.why = "it is an error of the lidar and none of odometry";
  return use;
}

EffectUse use_of(const odometry::Placement& placement) {
  EffectUse use;
  use.name = placement.parameter.empty() ? placement.effect : placement.effect + "." + placement.parameter;
  use.unit = placement.quantity.unit;
  use.value = placement.quantity.value;
  use.place = ODOMCALIB_IN_POSE;
  if (placement.place == odometry::Place::reference) return use_of_reference(placement, std::move(use));
  if (placement.place == odometry::Place::nowhere) {
    use.place = ODOMCALIB_LEFT_OUT;
    use.why =
        "it belongs to the place or the day: it takes a heading, a place or a time that odometry does "
        "not know";
  }
  return use;
}

/// Zero where values of the calibration lead nowhere.
Eigen::Matrix3d finite(const Eigen::Matrix3d& covariance) {
  if (covariance.allFinite()) return covariance;
  return Eigen::Matrix3d::Zero();
}

EffectUse left_out(const std::string& name, const char* why) {
  EffectUse use;
  use.name = name;
  use.place = ODOMCALIB_LEFT_OUT;
  use.why = why;
  return use;
}

}  // namespace

Drive::Drive(const Calibration& calibration, int counter_bits)
    : calibration_(calibration),
      odometry_(calibration),
      usual_uncertainty_(odometry::correction_of(calibration, false), noise_of(calibration)),
      uncertainty_of_time_(odometry::correction_of(calibration, true), noise_of(calibration)),
      covariance_is_whole_(odometry::contact_noise_of(calibration).has_value() &&
                           !calibration.covariance_order.empty()),
      wrap_(counter_bits),
      angles_(calibration.robot.ticks_per_rev),
      speeds_(calibration.robot.ticks_per_rev),
      gate_(metres_per_count_of(calibration.robot, calibration)),
      clock_offset_(stated(calibration, kTimeOffset, "offset")),
      lidar_(lidar_findings(calibration)) {
  list_effects();
}

double Drive::metres_per_count() const { return metres_per_count_of(calibration_.robot, calibration_); }

void Drive::list_effects() {
  for (const odometry::Placement& placement : odometry::effect_placements(calibration_))
    effects_.push_back(use_of(placement));
  for (const std::string& name : odometry::unknown_effects(calibration_)) {
    const auto of_it = [&](const EffectUse& use) { return use.name.starts_with(name + "."); };
    effects_.erase(std::remove_if(effects_.begin(), effects_.end(), of_it), effects_.end());
    effects_.push_back(
        left_out(name.empty() ? "(no name)" : name, "this version of the library does not know it"));
  }
  if (!calibration_.lidar_curves.empty())
    effects_.push_back(left_out("lidar_curves", "errors of the lidar without a name are reported only"));
}

int Drive::not_a_number(double stamp) {
  (void)std::snprintf(problem_.data(), problem_.size(),
                      "sample at %.6f s: stamp or motion is no finite number, or a count beyond 2^53", stamp);
  return ODOMCALIB_NOT_A_NUMBER;
}

int Drive::begin(Motion motion) {
  problem_.front() = '\0';
  if (motion_ == Motion::none) motion_ = motion;
  if (motion_ == motion) return ODOMCALIB_OK;
  (void)std::snprintf(problem_.data(), problem_.size(),
                      "this drive was begun with another kind of wheel motion: open the calibration again");
  return ODOMCALIB_OTHER_MOTION;
}

int Drive::update_counts(double stamp, const Counts& counts) {
  if (const int status = begin(Motion::counts); status != ODOMCALIB_OK) return status;
  if (!std::isfinite(stamp)) return not_a_number(stamp);
  const Counts continued = wrap_(counts);
  for (const std::int64_t count : continued)
    if (count > settings::kMostCounts || count < -settings::kMostCounts) return not_a_number(stamp);
  return take(stamp, continued);
}

int Drive::update_angles(double stamp, const std::array<double, 2>& angles) {
  if (const int status = begin(Motion::angles); status != ODOMCALIB_OK) return status;
  const bool finite = std::isfinite(stamp) && std::isfinite(angles[0]) && std::isfinite(angles[1]);
  const auto counts = finite ? angles_(angles) : std::nullopt;
  return counts ? take(stamp, *counts) : not_a_number(stamp);
}

int Drive::update_speeds(double stamp, const std::array<double, 2>& speeds) {
  if (const int status = begin(Motion::speeds); status != ODOMCALIB_OK) return status;
  const bool finite = std::isfinite(stamp) && std::isfinite(speeds[0]) && std::isfinite(speeds[1]);
  const auto counts = finite ? speeds_.at(stamp, speeds) : std::nullopt;
  if (!counts) return not_a_number(stamp);
  const double turns = std::max(std::abs(speeds[0]), std::abs(speeds[1])) / (2.0 * math::kPi);
  const double rim = turns * metres_per_count() * calibration_.robot.ticks_per_rev;
  if (rim > settings::kFastest) {
    (void)std::snprintf(problem_.data(), problem_.size(),
                        "sample at %.6f s: a wheel at %.4g m/s is no motion of a robot", stamp, rim);
    return ODOMCALIB_JUMP;
  }
  const int status = take(stamp, *counts);
  if (status == ODOMCALIB_OK) speeds_.keep();
  return status;
}

int Drive::rejected(Admission why, const TickSample& sample) {
  const TickSample& last = *gate_.last();
  if (why == Admission::not_later) {
    (void)std::snprintf(problem_.data(), problem_.size(),
                        "sample at %.6f s: no later than the one before, at %.6f s", sample.t, last.t);
    return ODOMCALIB_STAMP_NOT_LATER;
  }
  (void)std::snprintf(problem_.data(), problem_.size(),
                      "sample at %.6f s: counts jump by %lld left and %lld right in %.4g s", sample.t,
                      static_cast<long long>(sample.left - last.left),
                      static_cast<long long>(sample.right - last.right), sample.t - last.t);
  return ODOMCALIB_JUMP;
}

int Drive::take(double stamp, const Counts& counts) {
  const TickSample sample{stamp, counts[0], counts[1], segment_};
  const Admission admission = gate_.admit(sample);
  if (admission == Admission::jump || admission == Admission::not_later) return rejected(admission, sample);
  if (admission == Admission::anew) {
    ++segment_;
    // The counts that speeds made of the time in between are none of the motion.
    if (motion_ != Motion::speeds) (void)add(gate_.begin());
  }
  return add(sample);
}

int Drive::add(const TickSample& sample) {
  TickSample joined = sample;
  joined.segment = segment_;
  if (stamp_is_set_ && !(joined.t > stamp_)) odometry_.forget_samples();
  const math::Pose before = odometry_.reckoning().pose();
  const bool had_begun = odometry_.has_samples();
  odometry_.update(joined);
  stamp_ = joined.t;
  stamp_is_set_ = true;
  auto& uncertainty = odometry_.knows_time() ? uncertainty_of_time_ : usual_uncertainty_;
  if (!had_begun) return ODOMCALIB_OK;
  const math::Pose after = pose();
  if (!std::isfinite(after.x) || !std::isfinite(after.y) || !std::isfinite(after.yaw)) {
    odometry_.take_back();
    (void)std::snprintf(problem_.data(), problem_.size(),
                        "sample at %.6f s: with the values of this calibration it leads to no finite pose",
                        joined.t);
    return ODOMCALIB_NOT_A_NUMBER;
  }
  uncertainty.advance(odometry_.reckoning(), odometry_.interval(), before);
  return ODOMCALIB_OK;
}

int Drive::restart() {
  problem_.front() = '\0';
  gate_.restart();
  wrap_.restart();
  angles_.restart();
  speeds_.restart();
  ++segment_;
  return ODOMCALIB_OK;
}

int Drive::set_pose(const math::Pose& pose) {
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) {
    (void)std::snprintf(problem_.data(), problem_.size(), "the pose to begin from is no finite one");
    return ODOMCALIB_NOT_A_NUMBER;
  }
  const math::Pose origin = compose(pose, inverse(odometry_.reckoning().pose()));
  const math::Pose there = compose(origin, odometry_.reckoning().pose());
  if (!std::isfinite(there.x) || !std::isfinite(there.y)) return not_a_number(stamp_);
  problem_.front() = '\0';
  origin_ = origin;
  usual_uncertainty_.forget();
  uncertainty_of_time_.forget();
  return ODOMCALIB_OK;
}

math::Pose Drive::pose() const {
  const math::Pose pose = compose(origin_, odometry_.reckoning().pose());
  return {pose.x, pose.y, math::wrap_angle(pose.yaw)};
}

math::Pose Drive::velocity() const {
  const double duration = odometry_.duration();
  if (!(duration > 0.0)) return {};
  const math::Pose& way = odometry_.reckoning().twist();
  const math::Pose velocity{way.x / duration, way.y / duration, way.yaw / duration};
  const bool finite = std::isfinite(velocity.x) && std::isfinite(velocity.y) && std::isfinite(velocity.yaw);
  return finite ? velocity : math::Pose{};
}

Eigen::Matrix3d Drive::covariance() const {
  const Eigen::Matrix3d turn = math::rotation_about_z(origin_.yaw);
  return finite(turn * uncertainty().of_pose() * turn.transpose());
}

Eigen::Matrix3d Drive::velocity_covariance() const {
  const double duration = odometry_.duration();
  if (!(duration > 0.0)) return Eigen::Matrix3d::Zero();
  return finite(uncertainty().of_twist() / (duration * duration));
}

terms::BeamShift Drive::shift(const terms::Sighting& sighting) const {
  terms::BeamShift sum;
  for (const terms::LidarFinding& finding : lidar_) {
    const terms::BeamShift one = finding.effect->total(sighting, finding.values);
    sum.radial += one.radial;
    sum.angular += one.angular;
  }
  return sum;
}

}  // namespace odomcalib::calib::library
