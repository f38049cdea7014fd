#include "calib/selection/selection_json.hpp"

#include <nlohmann/json.hpp>
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

std::string considered_to_json(const std::vector<Considered>& considered) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Considered& c : considered)
    list.push_back({{"candidate", c.name},
                    {"statistic", c.statistic},
                    {"p_value", c.family_p_value},
                    {"outcome", c.outcome}});
  return list.dump();
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

std::string lidar_smooth_terms_to_json(const std::vector<terms::LidarFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const terms::LidarFinding& finding : findings) {
    if (finding.effect->is_named()) continue;
    nlohmann::ordered_json coefficients = nlohmann::ordered_json::object();
    const auto parameters = finding.effect->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) coefficients[parameters[k].name] = finding.values[k];
    list.push_back({{"variable", finding.effect->name()},
                    {"law_of_a_name", completes(finding, findings)},
                    {"corrected", finding.effect->is_correctable()},
                    {"held_out_before", finding.before},
                    {"held_out_after", finding.after},
                    {"coefficients", coefficients}});
  }
  return list.dump();
}

}  // namespace odomcalib::calib::selection
