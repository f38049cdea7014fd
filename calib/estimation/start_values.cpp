#include "calib/estimation/start_values.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/classical/closed_form.hpp"
#include "calib/classical/sign_check.hpp"
#include "calib/estimation/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/terms/catalogue.hpp"

namespace odomcalib::calib::estimation {
namespace {

/// Mean absolute misfit of rotation = a left + b right at this delay, a and b by least squares with one
/// reweighting.
double rotation_misfit(std::span<const measurement::FitData> data, double delay) {
  const auto motions = wheel_motions(data, delay);
  Eigen::Vector2d gains = Eigen::Vector2d::Zero();
  double misfit = 0.0;
  for (int round = 0; round < settings::kMisfitRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-9;
    Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
    const double limit = round == 0 ? 1e9 : misfit;
    double sum = 0.0;
    for (const wheels::WheelMotion& m : motions) {
      const Eigen::Vector2d wheels(m.left, m.right);
      const double residual = m.sensor_motion.yaw - gains.dot(wheels);
      const double weight = std::abs(residual) > limit ? limit / std::abs(residual) : 1.0;
      normal += weight * wheels * wheels.transpose();
      right_side += weight * m.sensor_motion.yaw * wheels;
    }
    gains = math::solve_symmetric(normal, right_side);
    for (const wheels::WheelMotion& m : motions)
      sum += std::abs(m.sensor_motion.yaw - gains.dot(Eigen::Vector2d(m.left, m.right)));
    misfit = sum / std::max(static_cast<double>(motions.size()), 1.0);
  }
  return misfit;
}

struct Delay {
  double seconds = 0.0;
  double misfit = 0.0;
};

Delay search_delay(std::span<const measurement::FitData> data) {
  const double at_zero = rotation_misfit(data, 0.0);
  Delay best{0.0, at_zero};
  for (double d = -settings::kDelayReach_s; d <= settings::kDelayReach_s + 1e-9;
       d += settings::kDelayStep_s) {
    const double misfit = rotation_misfit(data, d);
    if (misfit < best.misfit) best = {d, misfit};
  }
  return best.misfit < settings::kBelievableDelay * at_zero ? best : Delay{0.0, at_zero};
}

/// The first and the second half of each recording's pairs.
std::pair<std::vector<measurement::FitData>, std::vector<measurement::FitData>> halves(
    std::span<const measurement::FitData> data) {
  std::pair<std::vector<measurement::FitData>, std::vector<measurement::FitData>> both;
  for (const measurement::FitData& one : data) {
    const auto middle = one.pairs.begin() + static_cast<std::ptrdiff_t>(one.pairs.size() / 2);
    both.first.push_back({one.model, {one.pairs.begin(), middle}});
    both.second.push_back({one.model, {middle, one.pairs.end()}});
  }
  return both;
}

/// Mean time of the pairs, s.
double mean_time(std::span<const measurement::FitData> data) {
  double sum = 0.0, count = 0.0;
  for (const measurement::FitData& one : data)
    for (const measurement::SensorPair& pair : one.pairs) {
      sum += 0.5 * (pair.interval.begin + pair.interval.end);
      count += 1.0;
    }
  return sum / std::max(count, 1.0);
}

bool plausible(const wheels::BaseParameters& p) {
  return p.left_radius > 0.0 && p.right_radius > 0.0 && p.track_width > 0.0 && std::isfinite(p.track_width);
}

vehicle::VehicleModel with_start_values(const vehicle::EffectList& effects,
                                        const wheels::BaseParameters& base, const ClockStart& clock) {
  Eigen::VectorXd parameters = vehicle::to_vector(base, vehicle::count_parameters(effects));
  const std::vector<double> own = vehicle::start_of(effects);
  parameters.tail(static_cast<Eigen::Index>(own.size())) =
      Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size()));
  if (const auto offset = parameter_of(effects, vehicle::ClockPart::offset))
    parameters(*offset) = clock.delay;
  if (const auto rate = parameter_of(effects, vehicle::ClockPart::rate)) parameters(*rate) = clock.rate;
  return {effects, parameters};
}

/// Checks each recording alone first: one with exchanged wires beside sound ones is outvoted.
std::optional<Error> check_signs(const measurement::Dataset& rough, double delay) {
  const std::span<const measurement::FitData> data(rough.data);
  const RobotDescription& robot = rough.recordings.front().robot;
  const bool of_base = rough.reference_is_base();
  for (std::size_t i = 0; data.size() > 1 && i < data.size(); ++i)
    if (auto error = classical::check_signs(whole_wheel_motions(data.subspan(i, 1), delay), robot, of_base,
                                            rough.recordings[i].motion)) {
      error->where = rough.recordings[i].name;
      return error;
    }
  return classical::check_signs(whole_wheel_motions(data, delay), robot, of_base,
                                rough.recordings.front().motion);
}

}  // namespace

ClockStart search_clock(std::span<const measurement::FitData> data) {
  const auto [early, late] = halves(data);
  const Delay first = search_delay(early), second = search_delay(late);
  const auto contradicts = [](const std::vector<measurement::FitData>& half, const Delay& own,
                              const Delay& other) {
    return own.misfit < settings::kBelievableDelay * rotation_misfit(half, other.seconds);
  };
  const double apart = second.seconds - first.seconds;
  if (std::abs(apart) < settings::kClocksApart_s || !contradicts(early, first, second) ||
      !contradicts(late, second, first))
    return {search_delay(data).seconds, 0.0};
  const double rate = apart / (mean_time(late) - mean_time(early));
  if (std::abs(rate) > settings::kMostClockRate) return {search_delay(data).seconds, 0.0};
  return {0.5 * (first.seconds + second.seconds), rate};
}

wheels::BaseParameters start_values(const measurement::Dataset& dataset, double delay) {
  wheels::BaseParameters start = dataset.nominal;
  if (dataset.reference_is_base()) return start;
  const auto closed = classical::solve_closed_form(whole_wheel_motions(dataset.data, delay));
  if (!closed || !plausible(closed.value().parameters)) return start;
  const RobotDescription& robot = dataset.recordings.front().robot;
  // From a heading on the other side the fit ends at negative lengths as easily as at the lidar's own.
  const math::Pose& mount_found = closed.value().parameters.mount;
  const double elsewhere = math::wrap_angle(mount_found.yaw - start.mount.yaw);
  if (!robot.lidar_pose || std::abs(elsewhere) > settings::kOtherSide_rad) start.mount = mount_found;
  if (!(robot.left_wheel_diameter > 0.0)) {
    const math::Pose mount = start.mount;
    start = closed.value().parameters;
    start.mount = mount;
  }
  return start;
}

Result<vehicle::VehicleModel> start_model(const measurement::Dataset& rough, const terms::Request& request) {
  using vehicle::ClockPart;
  vehicle::EffectList effects = request.effects;
  if (request.is_automatic && !rough.has_motions_alone())
    effects.push_back(terms::clock_effect(ClockPart::offset));
  const bool has_offset = place_of(effects, ClockPart::offset).has_value();
  const ClockStart clock = has_offset ? search_clock(rough.data) : ClockStart{};
  if (auto error = check_signs(rough, clock.delay)) return *error;
  if (request.is_automatic && clock.rate != 0.0) effects.push_back(terms::clock_effect(ClockPart::rate));
  return with_start_values(effects, start_values(rough, clock.delay), clock);
}

}  // namespace odomcalib::calib::estimation
