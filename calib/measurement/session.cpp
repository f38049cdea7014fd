#include "calib/measurement/session.hpp"

#include <cmath>
#include <string>

#include "calib/ingest/recording_check.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/wheels/fine_track.hpp"
#include "calib/wheels/nominal_base.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// Khepera-sized start for tuple files, which carry no nominal geometry; the closed form replaces it.
constexpr double kUnknownRadius = 0.05;
constexpr double kUnknownTrackWidth = 0.3;

wheels::BaseParameters start_of(const RobotDescription& robot) {
  wheels::BaseParameters base = wheels::nominal_base(robot);
  if (!(base.left_radius > 0.0)) base.left_radius = kUnknownRadius;
  if (!(base.right_radius > 0.0)) base.right_radius = kUnknownRadius;
  if (!(base.track_width > 0.0)) base.track_width = kUnknownTrackWidth;
  return base;
}

bool same_robot(const RobotDescription& a, const RobotDescription& b) {
  return a.ticks_per_rev == b.ticks_per_rev && a.left_wheel_diameter == b.left_wheel_diameter &&
         a.right_wheel_diameter == b.right_wheel_diameter && a.track_width == b.track_width;
}

double wheel_angle(const wheels::WheelTrack& track, const std::vector<double>& angle, double time) {
  const std::size_t k = track.interval_at(time);
  const double share = (time - track.t[k]) / (track.t[k + 1] - track.t[k]);
  return angle[k] + share * (angle[k + 1] - angle[k]);
}

}  // namespace

Result<Session> Session::open(std::span<const Recording> recordings) {
  if (recordings.empty())
    return Error{ErrorCode::usage, "no recording given", "", "name at least one recording"};
  if (auto error = ingest::check_recordings(recordings)) return *error;
  Session session;
  session.recordings_ = recordings;
  session.nominal_ = start_of(recordings.front().robot);
  for (const Recording& recording : recordings) {
    if (!same_robot(recording.robot, recordings.front().robot))
      return Error{ErrorCode::format, "nominal values differ from those of " + recordings.front().name,
                   recording.name, "solve recordings of different robots separately"};
    wheels::WheelTrack track = recording.increments.empty()
                                   ? finely_sampled(wheels::wheel_track_from_ticks(recording))
                                   : wheels::wheel_track_from_increments(recording);
    if (track.empty())
      return Error{ErrorCode::empty, "tick times do not advance", recording.name,
                   "check the controller's clock"};
    std::vector<vehicle::StepContext> context = vehicle::make_context(track, session.nominal_);
    session.models_.emplace_back(std::move(track), std::move(context));
  }
  session.reference_is_base_ = recordings.front().increments.empty() && !recordings.front().poses.empty();
  if (session.reference_is_base_) session.nominal_.mount = {};
  return session;
}

bool Session::reference_is_scans() const {
  const Recording& first = recordings_.front();
  return first.increments.empty() && !first.scans.empty() && !reference_is_base_;
}

std::vector<bool> Session::fixed(std::size_t effect_parameters) const {
  std::vector<bool> fixed(vehicle::kBaseCount + effect_parameters, false);
  for (const auto k : {vehicle::kMountX, vehicle::kMountY, vehicle::kMountYaw})
    fixed[k] = reference_is_base_ && !reference_sits_anywhere_;
  return fixed;
}

void Session::measure(const Eigen::VectorXd& parameters, const vehicle::EffectList& effects,
                      const PairOptions& options) {
  data_.clear();
  sets_.clear();
  const std::span<const double> p = vehicle::as_span(parameters);
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    sets_.push_back(build_pairs(recordings_[i], models_[i], p, effects, options));
    data_.push_back({&models_[i], sets_.back().pairs});
  }
}

void Session::locate(std::span<const std::vector<vehicle::Fix>> fixes, const Eigen::VectorXd& parameters,
                     const vehicle::EffectList& effects) {
  for (std::size_t i = 0; i < models_.size(); ++i)
    models_[i].locate(fixes[i], vehicle::as_span(parameters), effects);
}

std::size_t Session::pair_count() const {
  std::size_t count = 0;
  for (const FitData& d : data_) count += d.pairs.size();
  return count;
}

std::vector<wheels::WheelMotion> wheel_motions(std::span<const FitData> data, double delay) {
  std::vector<wheels::WheelMotion> motions;
  for (const FitData& d : data) {
    const wheels::WheelTrack& track = d.model->track();
    for (const SensorPair& pair : d.pairs) {
      const double begin = pair.interval.begin - delay;
      const double end = pair.interval.end - delay;
      motions.push_back({wheel_angle(track, track.left, end) - wheel_angle(track, track.left, begin),
                         wheel_angle(track, track.right, end) - wheel_angle(track, track.right, begin),
                         pair.motion});
    }
  }
  return motions;
}

}  // namespace odomcalib::calib::measurement
