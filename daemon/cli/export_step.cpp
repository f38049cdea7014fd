#include "daemon/cli/export_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/settings.hpp"
#include "calib/vehicle/settings.hpp"
#include "daemon/cli/step_sources.hpp"

namespace odomcalib::cli {
namespace {

using calib::odometry::Correction;
using calib::vehicle::CovariateGroup;
namespace of_vehicle = calib::vehicle::settings;
namespace of_odometry = calib::odometry::settings;

/// Effects that the sources have a function for.
constexpr std::array<std::string_view, 15> kWritten = {"time_offset",
                                                       "encoder_lag",
                                                       "wheel_eccentricity",
                                                       "tick_loss",
                                                       "backlash",
                                                       "direction_dependent_diameter",
                                                       "speed_dependent_radius",
                                                       "acceleration_slip",
                                                       "lateral_slip",
                                                       "speed_dependent_track",
                                                       "track_depends_on_motion",
                                                       "turn_direction_asymmetry",
                                                       "caster_kick",
                                                       "stop_settling",
                                                       "drift_with_time"};

/// An effect with its values.
struct Written {
  std::string name;
  std::vector<double> values;
};

std::vector<Written> written_effects(const Correction& correction) {
  std::vector<Written> all;
  Eigen::Index next = calib::vehicle::kBaseCount;
  for (const auto& effect : correction.effects) {
    const auto& parameters = effect->parameters();
    Written one{effect->name(), {}};
    for (std::size_t k = 0; k < parameters.size(); ++k) one.values.push_back(correction.parameters(next++));
    if (!is_in_step(one.name)) continue;
    // One for each wheel, told apart by the parameters.
    if (one.name == "wheel_eccentricity")
      one.name += parameters.front().name.starts_with("left") ? "_left" : "_right";
    all.push_back(std::move(one));
  }
  return all;
}

/// Values of a shape that an effect looks at, the first effect's.
double shape_of(const std::vector<Written>& effects, std::string_view name, std::size_t parameter,
                double otherwise) {
  for (const Written& effect : effects)
    if (effect.name == name) return effect.values.at(parameter);
  return otherwise;
}

using Constants = std::vector<std::pair<std::string, double>>;

/// Values of the calibration, and the numbers by which effects look at a drive.
Constants constants_of(const Calibration& calibration, const Correction& correction,
                       const std::vector<Written>& effects) {
  using namespace calib::vehicle;  // NOLINT(google-build-using-namespace): names of grids
  const auto base = to_base(as_span(correction.parameters));
  const CovariateGroups groups = covariates_of(correction.effects);
  const auto uses = [&](CovariateGroup group) { return groups.contain(group) ? 1.0 : 0.0; };
  const double trail = shape_of(effects, "caster_kick", 3, kCasterTrails.front());
  const double lean = shape_of(effects, "caster_kick", 5, 0.0);
  const double relaxation = shape_of(effects, "lateral_slip", 2, kRelaxations.front());
  const DataUse* drive = calibration.data.empty() ? nullptr : &calibration.data.front();
  const bool has_clock = calibration.data.size() == 1 && drive->begin.has_value();
  return {{"LEFT_RADIUS", base.left_radius},
          {"RIGHT_RADIUS", base.right_radius},
          {"TRACK_WIDTH", base.track_width},
          {"COUNTS_PER_TURN", calibration.robot.ticks_per_rev},
          {"TICK_ANGLE", 2.0 * calib::math::kPi / calibration.robot.ticks_per_rev},
          {"DURATION", drive != nullptr ? drive->duration : 0.0},
          {"HAS_CLOCK", has_clock ? 1.0 : 0.0},
          {"CALIBRATED_BEGIN", has_clock ? *drive->begin : 0.0},
          {"TOGETHER", of_odometry::kTogether_s},
          {"AFTER_THE_DRIVE", of_odometry::kAfterTheDrive},
          {"USES_CHANGES", uses(CovariateGroup::acceleration_changes)},
          {"USES_GEARS", uses(CovariateGroup::gear_play)},
          {"USES_CASTER", uses(CovariateGroup::caster)},
          {"USES_TYRES", uses(CovariateGroup::tyre_relaxation)},
          {"USES_STOPS", uses(CovariateGroup::stops)},
          {"CASTER_TRAIL", kCasterTrails.at(nearest_of(kCasterTrails, trail))},
          {"CASTER_LEAN", kCasterLeans.at(nearest_of(kCasterLeans, lean))},
          {"RELAXATION", kRelaxations.at(nearest_of(kRelaxations, relaxation))},
          {"LEAST_RELAXATION", 0.5 * kRelaxations.front()},
          {"TURN_MEMORY", kMemorySpans.at(kUsualMemory)},
          {"SMOOTHING", of_vehicle::kSmoothing_s},
          {"SHARP_LATEST", of_vehicle::kSharpLatest_s},
          {"COARSE", of_vehicle::kCoarse_m},
          {"CURVATURE_INTERVALS", static_cast<double>(of_vehicle::kCurvatureIntervals)},
          {"STANDING_SPEED", of_vehicle::kStandingSpeed},
          {"ON_THE_SPOT_SHARE", of_vehicle::kOnTheSpotShare},
          {"CASTER_BEHIND", of_vehicle::kCasterBehind},
          {"BEFORE_THE_DRIVE", of_vehicle::kBeforeTheDrive},
          {"DITHER", of_vehicle::kDither},
          {"SLOW", of_vehicle::kSlow},
          {"SLOW_INTERVALS", static_cast<double>(of_vehicle::kSlowIntervals)},
          {"FEW_COUNTS", of_vehicle::kFewCounts},
          {"WIND_WAY", of_vehicle::kWindWay_m},
          {"WIND_TURN", of_vehicle::kWindTurn_rad},
          {"UNWIND", of_vehicle::kUnwind_s}};
}

void replace(std::string& text, std::string_view place, const std::string& by) {
  text.replace(text.find(place), place.size(), by);
}

/// The source with values in their places.
/// @param constant, call how the language writes them, with the name and the value or the arguments
std::string filled(const Calibration& calibration, std::string source, const char* constant,
                   const char* call) {
  const Correction correction = calib::odometry::correction_of(calibration, true);
  const std::vector<Written> effects = written_effects(correction);
  std::string values, calls;
  for (const auto& [name, value] : constants_of(calibration, correction, effects))
    values += fmt::format(fmt::runtime(constant), name, value);
  for (const Written& effect : effects)
    calls += fmt::format(fmt::runtime(call), effect.name, fmt::join(effect.values, ", "));
  replace(source, "@VALUES@\n", values);
  replace(source, "@EFFECTS@", calls);
  replace(source, "@kHistory@", std::to_string(of_odometry::kHistory));
  replace(source, "@kPlays@", fmt::format("{}", fmt::join(calib::vehicle::kPlays, ", ")));
  return source;
}

}  // namespace

bool is_in_step(const std::string& effect) {
  return std::find(kWritten.begin(), kWritten.end(), effect) != kWritten.end();
}

std::string step_in_c(const Calibration& calibration) {
  return filled(calibration, kStepInC, "#define OC_{} ({})\n", "  oc_{}(c, m, {});\n");
}

std::string step_in_python(const Calibration& calibration) {
  return filled(calibration, kStepInPython, "{} = {}\n", "    _{}(c, m, {})\n");
}

}  // namespace odomcalib::cli
