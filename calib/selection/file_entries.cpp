#include "calib/selection/file_entries.hpp"

#include <utility>
#include <variant>

#include "calib/math/number_text.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {
namespace {

std::string percent(double share) { return math::signed_fixed(1e2 * share, 2) + " %"; }
std::string millimetres(double metres) { return math::signed_fixed(1e3 * metres, 1) + " mm"; }

/// The smooth term's coefficients move the base as the sensor sees it, the other way round.
math::Pose moved_by(const std::vector<double>& coefficients, const math::Pose& mount) {
  const math::Pose before = compose({-coefficients[0], -coefficients[1], -coefficients[2]}, mount);
  return {mount.x - before.x, mount.y - before.y, coefficients[2]};
}

std::string change_of_place(const std::vector<double>& coefficients, const math::Pose& mount) {
  const math::Pose by = moved_by(coefficients, mount);
  return "the lidar was moved on the robot (x " + millimetres(by.x) + ", y " + millimetres(by.y) + ", yaw " +
         math::signed_fixed(by.yaw * 180.0 / math::kPi, 2) +
         " deg); its pose is the one since then: fasten it";
}

std::string change_of_wheels(const std::vector<double>& c) {
  return "the wheels changed at once (left " + percent(c[0]) + ", right " + percent(c[1]) +
         "), as when a load is taken up or a tyre loses air; the diameters are those over the whole drive: "
         "calibrate again as the robot will work";
}

std::string change_of_track(const std::vector<double>& c) {
  return "the track width changed at once (" + percent(c[0]) +
         "); the one stated is that over the whole drive: calibrate again as the robot will work";
}

}  // namespace

std::vector<ConsideredTerm> entries_of(const std::vector<Considered>& considered) {
  std::vector<ConsideredTerm> entries;
  entries.reserve(considered.size());
  for (const Considered& c : considered)
    entries.push_back({c.name, c.statistic, c.family_p_value, c.outcome});
  return entries;
}

std::string event_to_text(const terms::FittedSmoothTerm& event, const math::Pose& mount) {
  const std::string when =
      math::fixed(std::get<terms::ChangePoint>(event.smooth.basis).moment, 1) + " s after the beginning ";
  if (is_bump(event.smooth)) return when + change_of_place(event.coefficients, mount);
  if (event.smooth.dependence.channel == vehicle::Channel::track)
    return when + change_of_track(event.coefficients);
  return when + change_of_wheels(event.coefficients);
}

std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings) {
  std::vector<EffectResult> all;
  for (const terms::LidarFinding& finding : findings) {
    if (!finding.effect->is_named()) continue;
    EffectResult result;
    result.name = finding.effect->name();
    result.parameters = finding.effect->quantities(finding.values, finding.deviations);
    result.aliases = finding.effect->aliases();
    result.evidence = {finding.family_p_value, finding.before, finding.after};
    all.push_back(std::move(result));
  }
  return all;
}

std::vector<LidarCurve> lidar_curves(const std::vector<terms::LidarFinding>& findings) {
  std::vector<LidarCurve> curves;
  for (const terms::LidarFinding& finding : findings) {
    if (finding.effect->is_named()) continue;
    LidarCurve curve{finding.effect->name(),
                     completes(finding, findings),
                     finding.effect->is_correctable(),
                     finding.before,
                     finding.after,
                     {}};
    const auto& parameters = finding.effect->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k)
      curve.coefficients.emplace_back(parameters[k].name, finding.values[k]);
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace odomcalib::calib::selection
