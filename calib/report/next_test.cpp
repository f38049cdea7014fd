#include "calib/report/next_test.hpp"

#include "calib/report/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::calib::report {
namespace {

/// Aliases that some motion separates from the effect.
std::vector<std::string> separable(const EffectResult& result, const vehicle::Effect& effect) {
  std::vector<std::string> names = result.aliases;
  for (const std::string& alike : effect.observationally_equivalent()) std::erase(names, alike);
  return names;
}

std::optional<NextTest> for_ambiguity(const Calibration& calibration) {
  for (const EffectResult& result : calibration.effects) {
    const auto effect = terms::find_effect(result.name);
    if (!effect || effect->manoeuvre().empty()) continue;
    std::string others;
    for (const auto& name : separable(result, *effect)) others += (others.empty() ? "" : ", ") + name;
    if (others.empty()) continue;
    return NextTest{effect->manoeuvre(), result.name + " cannot be separated from " + others +
                                             " with what was driven; it takes " +
                                             effect->separating_motion()};
  }
  return std::nullopt;
}

std::optional<NextTest> for_unnamed(const Calibration& calibration) {
  if (!calibration.unexplained) return std::nullopt;
  for (const std::string& variable : calibration.unexplained->depends_on) {
    const auto covariate = vehicle::covariate_from(variable);
    const std::string manoeuvre = covariate ? vehicle::manoeuvre_for(*covariate) : "";
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
    if (!is_drive_length(parameter.first)) continue;
    if (worst == nullptr || relative(parameter.second) > relative(worst->second)) worst = &parameter;
  }
  if (worst == nullptr || relative(worst->second) <= settings::kGoodEnough) return std::nullopt;
  const bool track = is_name_of(worst->first, BaseQuantity::track_width);
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
