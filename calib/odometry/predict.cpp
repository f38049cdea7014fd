#include "calib/odometry/predict.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "calib/ingest/tick_stamps.hpp"
#include "calib/math/vector2.hpp"
#include "calib/odometry/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/effects/reference_effect.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/vehicle/drive_history.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/step_context.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::odometry {
namespace {

/// Wheels that warm up or leak change with the time since the calibration's own drive began. A drive that
/// begins on the same clock, during that one or no longer after its end than it took, finds the wheels as
/// they were at that moment, and later as they were at the end: how they went on nobody measured. When any
/// other drive begins, nobody knows how warm they are: they count by the middle of the calibration's drive.
class DriveClock {
 public:
  DriveClock() = default;
  /// @param stamp of the first ticks of the drive, s
  DriveClock(const Calibration& calibration, double stamp);
  [[nodiscard]] bool is_known() const { return begin_.has_value(); }
  /// @return s since the beginning of the calibration's drive, from zero to its duration
  [[nodiscard]] double at(double stamp) const;

 private:
  double duration_ = 0.0;
  std::optional<double> begin_;  ///< of the calibration's drive, where its clock is also that of this one
};

DriveClock::DriveClock(const Calibration& calibration, double stamp) {
  if (calibration.data.empty()) return;
  const DataUse& drive = calibration.data.front();
  duration_ = drive.duration;
  // Several drives share no zero of time.
  if (calibration.data.size() > 1 || !drive.begin) return;
  const double since = stamp - *drive.begin;
  if (since >= -settings::kTogether_s && since <= settings::kAfterTheDrive * duration_) begin_ = drive.begin;
}

double DriveClock::at(double stamp) const {
  return begin_ ? std::clamp(stamp - *begin_, 0.0, duration_) : duration_ / 2.0;
}

struct Correction {
  Eigen::VectorXd parameters;
  vehicle::EffectList effects;
};

double value_or(const Calibration& calibration, const std::string& name, double otherwise) {
  return calibration.parameter(name).value_or(otherwise);
}

/// What goes up and down with time begins the next drive anywhere, unless it rounds off a drift.
bool carries_over(const terms::FittedSmoothTerm& fitted) {
  const terms::SmoothTerm& smooth = fitted.smooth;
  if (make_smooth_term_effect(smooth)->carries_over()) return true;
  const auto named = terms::find_effect(fitted.named_term);
  return named && named->carries_over() && smooth.dependence.covariate == vehicle::Covariate::time &&
         !is_the_lidars(smooth);
}

/// What belongs to the place or the day would make odometry worse elsewhere and tomorrow; an error of the
/// lidar is none of odometry.
Place place_of(const vehicle::Effect& effect) {
  if (terms::concerns_reference(effect)) return Place::reference;
  const bool stays_behind = effect.storage() == vehicle::Storage::nowhere && !effect.carries_over();
  return stays_behind ? Place::nowhere : Place::odometry;
}

Place place_of(const vehicle::Effect& effect, const vehicle::EffectParameter& parameter) {
  return parameter.of_wheels ? Place::odometry : place_of(effect);
}

Place place_of(const terms::FittedSmoothTerm& fitted) {
  return carries_over(fitted) ? Place::odometry : place_of(*make_smooth_term_effect(fitted.smooth));
}

/// @param parameter name of one, as a file states it
Place place_of(const vehicle::Effect& effect, const std::string& parameter) {
  for (const vehicle::EffectParameter& own : effect.parameters())
    if (own.name == parameter) return place_of(effect, own);
  return place_of(effect);
}

bool acts_on_odometry(const vehicle::Effect& effect) {
  const auto parameters = effect.parameters();
  return std::any_of(parameters.begin(), parameters.end(), [&](const vehicle::EffectParameter& p) {
    return place_of(effect, p) == Place::odometry;
  });
}

/// The effect that the values were fitted for; null when this program does not know it.
std::shared_ptr<const vehicle::Effect> effect_of(const EffectResult& result) {
  if (result.parameters.empty()) return nullptr;
  const auto effect = terms::find_effect(result.name, result.parameters.front().first);
  return effect && result.parameters.size() <= effect->parameters().size() ? effect : nullptr;
}

/// Parameters that the file does not state, as those of another program may not, stay where a fit begins.
std::vector<double> values_of(const EffectResult& result,
                              const std::shared_ptr<const vehicle::Effect>& effect) {
  std::vector<double> values = vehicle::start_of({effect});
  for (std::size_t k = 0; k < result.parameters.size(); ++k) values[k] = result.parameters[k].second.value;
  return values;
}

std::vector<terms::FittedSmoothTerm> smooths_of(const Calibration& calibration) {
  const auto member = calibration.extensions.find(terms::kSmoothTermsMember);
  return member == calibration.extensions.end() ? std::vector<terms::FittedSmoothTerm>{}
                                                : terms::smooth_terms_from_json(member->second);
}

/// A smooth term of time is about its mean: where the time is not known, nothing is better known than that.
Correction correction_of(const Calibration& calibration, const DriveClock& clock) {
  wheels::BaseParameters base;
  base.left_radius =
      value_or(calibration, "left_wheel_diameter", calibration.robot.left_wheel_diameter) / 2.0;
  base.right_radius =
      value_or(calibration, "right_wheel_diameter", calibration.robot.right_wheel_diameter) / 2.0;
  base.track_width = value_or(calibration, "track_width", calibration.robot.track_width);
  Correction correction{vehicle::to_vector(base), {}};
  std::vector<double> values(correction.parameters.data(),
                             correction.parameters.data() + vehicle::kBaseCount);
  for (const EffectResult& result : calibration.effects) {
    const auto effect = effect_of(result);
    if (!effect || !acts_on_odometry(*effect)) continue;
    correction.effects.push_back(effect);
    const std::vector<double> own = values_of(result, effect);
    values.insert(values.end(), own.begin(), own.end());
  }
  for (const terms::FittedSmoothTerm& fitted : smooths_of(calibration)) {
    if (place_of(fitted) != Place::odometry) continue;
    if (fitted.smooth.dependence.covariate == vehicle::Covariate::time && !clock.is_known()) continue;
    correction.effects.push_back(make_smooth_term_effect(fitted.smooth));
    values.insert(values.end(), fitted.coefficients.begin(), fitted.coefficients.end());
  }
  correction.parameters =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return correction;
}

}  // namespace

std::vector<Placement> effect_placements(const Calibration& calibration) {
  std::vector<Placement> placements;
  for (const EffectResult& result : calibration.effects) {
    const auto effect = effect_of(result);
    const Place otherwise = terms::find_lidar_effect(result.name) ? Place::reference : Place::nowhere;
    for (const auto& [name, quantity] : result.parameters)
      placements.push_back({result.name, name, quantity, effect ? place_of(*effect, name) : otherwise});
  }
  for (const terms::FittedSmoothTerm& fitted : smooths_of(calibration)) {
    const Quantity count{static_cast<double>(fitted.coefficients.size()), -1.0, "coefficients"};
    placements.push_back({make_smooth_term_effect(fitted.smooth)->name(), "", count, place_of(fitted)});
  }
  return placements;
}

std::vector<std::string> unknown_effects(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const EffectResult& result : calibration.effects)
    if (!effect_of(result) && !terms::find_lidar_effect(result.name)) names.push_back(result.name);
  return names;
}

Calibration nominal_calibration(const RobotDescription& robot) {
  Calibration calibration;
  calibration.robot = robot;
  calibration.parameters = {{"left_wheel_diameter", {robot.left_wheel_diameter, -1.0, "m"}},
                            {"right_wheel_diameter", {robot.right_wheel_diameter, -1.0, "m"}},
                            {"track_width", {robot.track_width, -1.0, "m"}}};
  calibration.reasons = {"nominal values"};
  return calibration;
}

std::vector<PoseSample> predict(const Recording& recording, const Calibration& calibration) {
  std::vector<PoseSample> poses;
  Recording counted;
  counted.robot = recording.robot;
  counted.ticks = recording.ticks;
  if (const auto even = ingest::even_ticks(recording)) ingest::set_stamps(counted.ticks, even->t);
  const wheels::WheelTrack track = wheels::wheel_track_from_ticks(counted);
  if (track.empty()) return poses;
  const DriveClock clock(calibration, track.t.front());
  const Correction correction = correction_of(calibration, clock);
  std::vector<vehicle::StepContext> context = vehicle::make_context(
      track, vehicle::to_base(vehicle::as_span(correction.parameters)), covariates_of(correction.effects));
  for (vehicle::StepContext& c : context) c.t = clock.at(track.t.front() + c.t);
  const vehicle::DriveModel model(track, std::move(context));
  const std::vector<math::Pose> base =
      model.trajectory(vehicle::as_span(correction.parameters), correction.effects).poses();
  std::size_t k = 0;
  for (std::size_t i = 0; i < recording.ticks.size(); ++i) {
    // Repeated stamps keep the pose.
    while (k + 1 < track.t.size() && track.t[k + 1] <= counted.ticks[i].t) ++k;
    poses.push_back({recording.ticks[i].t, base[k].x, base[k].y, math::wrap_angle(base[k].yaw)});
  }
  return poses;
}

struct Odometry::State {
  Calibration calibration;
  DriveClock clock;
  Correction correction;
  std::deque<TickSample> history;
  math::Pose pose;
  vehicle::CovariateGroups groups;  ///< that the correction looks at
  vehicle::DriveHistory drive{{}, 0.0};

  [[nodiscard]] double ticks_per_rev() const { return calibration.robot.ticks_per_rev; }

  void begin(double stamp) {
    clock = DriveClock(calibration, stamp);
    correction = correction_of(calibration, clock);
    const double tick_angle = ticks_per_rev() > 0.0 ? 2.0 * math::kPi / ticks_per_rev() : 0.0;
    groups = covariates_of(correction.effects);
    drive =
        vehicle::DriveHistory(vehicle::to_base(vehicle::as_span(correction.parameters)), tick_angle, groups);
  }
};

Odometry::Odometry(const Calibration& calibration) : state_(std::make_unique<State>()) {
  state_->calibration = calibration;
}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

PoseSample Odometry::update(const TickSample& sample) {
  State& s = *state_;
  if (s.history.empty()) s.begin(sample.t);
  const bool advances = !s.history.empty() && sample.t > s.history.back().t;
  if (s.history.empty() || advances) s.history.push_back(sample);
  if (s.history.size() > settings::kHistory) s.history.pop_front();
  if (!advances || !(s.ticks_per_rev() > 0.0))
    return {sample.t, s.pose.x, s.pose.y, math::wrap_angle(s.pose.yaw)};

  // The last interval, seen with the history before it; what accumulates over the whole drive is carried
  // along.
  Recording recent;
  recent.robot.ticks_per_rev = s.ticks_per_rev();
  recent.ticks.assign(s.history.begin(), s.history.end());
  const wheels::WheelTrack track = wheels::wheel_track_from_ticks(recent);
  const std::size_t n = track.t.size();
  const wheels::BaseParameters base = vehicle::to_base(vehicle::as_span(s.correction.parameters));
  vehicle::StepContext context =
      vehicle::make_context_of_moment(track, base, s.groups, n - std::min<std::size_t>(n, 3)).back();
  see_from_the_past(context, track, base, s.groups);
  context.t = s.clock.at(sample.t);
  s.drive.advance(context);

  wheels::WheelTrack last{{track.t[n - 2], track.t[n - 1]},
                          {track.left[n - 2], track.left[n - 1]},
                          {track.right[n - 2], track.right[n - 1]},
                          {track.segment[n - 2], track.segment[n - 1]}};
  const vehicle::DriveModel model(std::move(last), {context});
  s.pose = compose(
      s.pose,
      model.trajectory(vehicle::as_span(s.correction.parameters), s.correction.effects).poses().back());
  return {sample.t, s.pose.x, s.pose.y, math::wrap_angle(s.pose.yaw)};
}

std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width) {
  const Eigen::Vector3d per_metre = Eigen::Vector3d(noise[0], noise[1], noise[2]).cwiseAbs2();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double dx = path[k].x - path[k - 1].x;
    const double dy = path[k].y - path[k - 1].y;
    // Mean of both wheels, whichever way each rolls.
    const double rolled =
        std::max(std::hypot(dx, dy), 0.5 * track_width * std::abs(path[k].yaw - path[k - 1].yaw));
    // An error of the heading moves all that follows sideways; that of the increment is in its own frame.
    Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
    carried(0, 2) = -dy;
    carried(1, 2) = dx;
    const Eigen::Matrix3d turn = math::rotation_about_z(path[k - 1].yaw);
    covariance = carried * covariance * carried.transpose() +
                 rolled * (turn * per_metre.asDiagonal() * turn.transpose());
  }
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

}  // namespace odomcalib::calib::odometry
