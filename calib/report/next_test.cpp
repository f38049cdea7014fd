#include "calib/report/next_test.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "calib/terms/catalogue.hpp"

namespace odomcalib::calib::report {
namespace {

/// Relative deviation of a length that more driving hardly improves: scan matching in one room is no better.
constexpr double kGoodEnough = 5e-4;

struct Named {
  std::string_view name;
  std::string_view manoeuvre;
};

/// What the effects' separating_motion() says, as a manoeuvre that can be driven in a small area.
constexpr std::array kForEffects = {Named{"time_offset", "accelerations"},
                                    Named{"acceleration_slip", "accelerations"},
                                    Named{"encoder_lag", "accelerations"},
                                    Named{"scan_skew", "turns"},
                                    Named{"speed_dependent_track", "turns"},
                                    Named{"turn_direction_asymmetry", "turns"},
                                    Named{"track_depends_on_motion", "arcs"},
                                    Named{"lateral_slip", "arcs"},
                                    Named{"wheel_eccentricity", "slow_straights"},
                                    Named{"backlash", "reversals"},
                                    Named{"caster_kick", "reversals"},
                                    Named{"stop_settling", "reversals"},
                                    Named{"direction_dependent_diameter", "straights"},
                                    Named{"speed_dependent_radius", "straights"},
                                    Named{"floor_slope", "headings"},
                                    Named{"carpet", "headings"},
                                    Named{"tick_loss", "straights"}};

constexpr std::array kForVariables = {Named{"left_speed", "straights"},
                                      Named{"right_speed", "straights"},
                                      Named{"wheel_speed", "straights"},
                                      Named{"speed", "straights"},
                                      Named{"turn_rate", "turns"},
                                      Named{"lateral_acceleration", "arcs"},
                                      Named{"left_acceleration", "accelerations"},
                                      Named{"right_acceleration", "accelerations"},
                                      Named{"acceleration", "accelerations"},
                                      Named{"left_phase", "slow_straights"},
                                      Named{"right_phase", "slow_straights"},
                                      Named{"heading", "headings"},
                                      Named{"since_reversal", "reversals"},
                                      Named{"left_since_reversal", "reversals"},
                                      Named{"right_since_reversal", "reversals"},
                                      Named{"since_stop", "accelerations"},
                                      Named{"previous_push", "accelerations"},
                                      Named{"previous_turn", "turns"}};

template <typename Table>
std::string manoeuvre_of(const Table& table, const std::string& name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const Named& n) { return n.name == name; });
  return found == table.end() ? "" : std::string(found->manoeuvre);
}

/// Aliases that some motion can tell from the effect.
std::vector<std::string> separable(const EffectResult& result, const vehicle::Effect& effect) {
  std::vector<std::string> names = result.aliases;
  for (const std::string& alike : effect.always_alike()) std::erase(names, alike);
  return names;
}

std::optional<NextTest> for_ambiguity(const Calibration& calibration) {
  for (const EffectResult& result : calibration.effects) {
    const auto effect = terms::find_effect(result.name);
    const std::string manoeuvre = manoeuvre_of(kForEffects, result.name);
    if (!effect || manoeuvre.empty()) continue;
    std::string others;
    for (const auto& name : separable(result, *effect)) others += (others.empty() ? "" : ", ") + name;
    if (others.empty()) continue;
    return NextTest{manoeuvre, result.name + " cannot be told from " + others +
                                   " with what was driven; it takes " + effect->separating_motion()};
  }
  return std::nullopt;
}

std::optional<NextTest> for_unnamed(const Calibration& calibration) {
  if (!calibration.unexplained) return std::nullopt;
  for (const std::string& variable : calibration.unexplained->depends_on) {
    const std::string manoeuvre = manoeuvre_of(kForVariables, variable);
    if (!manoeuvre.empty())
      return NextTest{manoeuvre, "the residual depends on " + variable +
                                     " in a way that has no name; more such motion makes its curve certain"};
  }
  return std::nullopt;
}

std::optional<NextTest> for_uncertainty(const Calibration& calibration) {
  const std::pair<std::string, Quantity>* worst = nullptr;
  const auto relative = [](const Quantity& q) { return q.value > 0.0 ? q.std / q.value : 0.0; };
  for (const auto& parameter : calibration.parameters) {
    if (parameter.first.starts_with("lidar_")) continue;
    if (worst == nullptr || relative(parameter.second) > relative(worst->second)) worst = &parameter;
  }
  if (worst == nullptr || relative(worst->second) <= kGoodEnough) return std::nullopt;
  const bool track = worst->first == "track_width";
  return NextTest{track ? "turns" : "straights", worst->first + " is the least certain dimension"};
}

}  // namespace

std::optional<NextTest> next_test(const Calibration& calibration) {
  if (calibration.verdict == Verdict::refused) return std::nullopt;
  if (auto test = for_ambiguity(calibration)) return test;
  if (auto test = for_unnamed(calibration)) return test;
  return for_uncertainty(calibration);
}

}  // namespace odomcalib::calib::report
