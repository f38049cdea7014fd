#include "daemon/cli/plain_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>

#include "calib/odometry/correction.hpp"
#include "calib/terms/catalogue.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/angles.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::cli {
namespace {

using calib::terms::meaning_of;
using calib::terms::ParameterMeaning;

/// Where an effect sits and what a person can look at there. Parameters that begin with left_ or right_ are
/// of that wheel.
struct EffectPlace {
  std::string_view effect;
  Spot spot;
  std::string_view look_at;
};

constexpr auto kEffectPlaces = std::to_array<EffectPlace>({
    {"time_offset", Spot::clocks, "stamps that are given when a scan arrives; a filter on the counts"},
    {"clock_drift", Spot::clocks, "two clocks that nothing synchronises: stamp both by one"},
    {"encoder_lag", Spot::clocks, "encoders that are read one after the other, or filtered differently"},
    {"scan_skew", Spot::lidar, "time between beams (time_increment) in the settings of the driver"},
    {"wheel_eccentricity", Spot::axle, "rim, hub and tyre; an encoder disc that is not centred"},
    {"tick_loss", Spot::axle, "encoder, its cable, and the fastest count that the input takes"},
    {"backlash", Spot::axle, "gear, key and coupling between motor and wheel"},
    {"direction_dependent_diameter", Spot::axle, "tread and bearing: they yield to one direction"},
    {"speed_dependent_radius", Spot::axle, "pressure of the tyres; soft rubber"},
    {"acceleration_slip", Spot::axle, "tread, and load on the driven wheels; accelerate more gently"},
    {"lateral_slip", Spot::axle, "play of the wheels across, toe, and tyres that yield sideways"},
    {"speed_dependent_track", Spot::axle, "broad or soft tyres, which scrub in turns"},
    {"track_depends_on_motion", Spot::axle, "broad or soft tyres, which scrub in turns"},
    {"turn_direction_asymmetry", Spot::axle, "load on one side; a cable that pulls"},
    {"caster_kick", Spot::caster, "swivel of the casters: stiff, dirty or bent"},
    {"stop_settling", Spot::axle, "brake and controller: what winds up at a stop and lets go"},
    {"drift_with_time", Spot::axle, "tyres that warm up or lose air; load that shifts"},
    {"floor_slope", Spot::floor, "the floor, which slopes"},
    {"carpet", Spot::floor, "the floor, whose pile carries the wheels"},
    {"range_bias", Spot::lidar, "offset of ranges in the settings of the driver"},
    {"angle_scale", Spot::lidar, "resolution of angles in the settings of the driver; cover glass"},
    {"lidar_tilt", Spot::lidar, "mount of the lidar, which leans"},
});

const EffectPlace* effect_place(std::string_view effect) {
  const auto* found = std::find_if(kEffectPlaces.begin(), kEffectPlaces.end(),
                                   [&](const EffectPlace& one) { return one.effect == effect; });
  return found == kEffectPlaces.end() ? nullptr : found;
}

/// Signed error of odometry with the nominal values; nullopt where these are not all known.
struct NominalErrors {
  double metre_mm, turn_deg;
};

std::optional<NominalErrors> nominal_errors(const Calibration& calibration) {
  const RobotDescription& robot = calibration.robot;
  const auto left = calibration.parameter(BaseQuantity::left_wheel_diameter);
  const auto right = calibration.parameter(BaseQuantity::right_wheel_diameter);
  const auto track = calibration.parameter(BaseQuantity::track_width);
  if (!left || !right || !track || !(robot.left_wheel_diameter > 0.0) ||
      !(robot.right_wheel_diameter > 0.0) || !(robot.track_width > 0.0))
    return std::nullopt;
  const double l = robot.left_wheel_diameter / *left, r = robot.right_wheel_diameter / *right;
  return NominalErrors{500.0 * (l + r) - 1000.0, 360.0 * (0.5 * (l + r) * *track / robot.track_width - 1.0)};
}

/// A direction is plain where the dimensions alone make most of what was measured.
std::string direction(double by_dimensions, double measured, const char* more, const char* less) {
  if (!(std::abs(by_dimensions) > settings::kPlainDirection * measured)) return "";
  return by_dimensions > 0.0 ? more : less;
}

/// "[a|b]" becomes a or b by the sign, "{}" the value.
std::string filled(std::string_view said, double value, const std::string& shown) {
  std::string out;
  for (std::size_t at = 0; at < said.size();) {
    if (said.substr(at, 2) == "{}") {
      out += shown;
      at += 2;
    } else if (said[at] == '[') {
      const std::size_t bar = said.find('|', at), end = said.find(']', at);
      out += value < 0.0 ? said.substr(bar + 1, end - bar - 1) : said.substr(at + 1, bar - at - 1);
      at = end + 1;
    } else {
      out += said[at++];
    }
  }
  return out;
}

std::string with_unit(double value, const std::string& unit) {
  return unit.empty() ? plain_number(value) : plain_number(value) + " " + unit;
}

std::string in_words(const std::string& effect, const std::string& parameter, const Quantity& quantity) {
  const ParameterMeaning* meaning = meaning_of(effect, parameter);
  if (meaning == nullptr || meaning->said.empty() || quantity.value == 0.0) return "";
  const Display show = display_of(effect, parameter, quantity);
  return filled(meaning->said, quantity.value, with_unit(quantity.value * show.factor, show.unit));
}

Spot spot_of(const EffectResult& effect, std::string_view parameter) {
  if (parameter.starts_with("left_")) return Spot::left_wheel;
  if (parameter.starts_with("right_")) return Spot::right_wheel;
  const EffectPlace* place = effect_place(effect.name);
  return place == nullptr ? Spot::axle : place->spot;
}

std::string remedy_of(const Calibration& calibration, const std::string& effect) {
  using calib::odometry::Place;
  for (const auto& placement : calib::odometry::effect_placements(calibration)) {
    if (placement.effect != effect) continue;
    if (placement.place == Place::odometry) return "odometry with this calibration corrects it";
    if (placement.place == Place::reference) return "no error of odometry: scans are read with it";
  }
  return "not corrected: of this place, day or drive";
}

/// Finding for a wheel that is off its centre: two parameters are one size.
std::optional<Finding> off_centre(const Calibration& calibration, const EffectResult& effect,
                                  const std::string& side) {
  double square = 0.0;
  for (const auto& [name, quantity] : effect.parameters)
    if (name.starts_with(side + "_")) square += quantity.value * quantity.value;
  const auto diameter = calibration.parameter(side + "_wheel_diameter");
  if (!(square > 0.0) || !diameter) return std::nullopt;
  const double share = std::sqrt(square);
  return Finding{side == "left" ? Spot::left_wheel : Spot::right_wheel,
                 fmt::format("{} wheel {} mm off centre, {} % of its radius", side,
                             plain_number(500.0 * share * *diameter), plain_number(100.0 * share)),
                 "", ""};
}

std::vector<Finding> findings_of(const Calibration& calibration, const EffectResult& effect) {
  std::vector<Finding> findings;
  if (effect.name == "wheel_eccentricity") {
    for (const char* side : {"left", "right"})
      if (auto one = off_centre(calibration, effect, side)) findings.push_back(*std::move(one));
  } else {
    for (const auto& [name, quantity] : effect.parameters)
      if (std::string words = in_words(effect.name, name, quantity); !words.empty())
        findings.push_back({spot_of(effect, name), std::move(words), "", ""});
  }
  if (findings.empty()) findings.push_back({spot_of(effect, ""), readable(effect.name), "", ""});
  const EffectPlace* place = effect_place(effect.name);
  for (Finding& one : findings) {
    one.look_at = place == nullptr ? "" : std::string(place->look_at);
    one.remedy = remedy_of(calibration, effect.name);
  }
  return findings;
}

/// Difference of a parameter from what was stated; nullopt within two deviations.
std::optional<double> difference(const Calibration& calibration, BaseQuantity of, double stated) {
  for (const auto& [key, quantity] : calibration.parameters) {
    if (!is_name_of(key, of)) continue;
    double by = quantity.value - stated;
    if (quantity.unit == "rad") by = std::remainder(by, 2.0 * std::numbers::pi);
    if (std::abs(by) > 2.0 * std::max(quantity.std, 0.0) && by != 0.0) return by;
  }
  return std::nullopt;
}

void add_length(const Calibration& calibration, BaseQuantity length, Spot spot, const char* words,
                std::vector<Finding>& findings) {
  const double stated = nominal_value(calibration.robot, length).value_or(0.0);
  if (!(stated > 0.0)) return;
  const auto by = difference(calibration, length, stated);
  if (!by) return;
  const std::string size =
      fmt::format("{} mm ({} %)", plain_number(1000.0 * *by), plain_number(100.0 * *by / stated));
  findings.push_back({spot, filled(words, *by, size), "", "the new value corrects it"});
}

void add_lidar(const Calibration& calibration, std::vector<Finding>& findings) {
  if (!calibration.robot.lidar_pose) return;
  const auto& stated = *calibration.robot.lidar_pose;
  std::vector<std::string> parts;
  const auto add = [&](BaseQuantity quantity, double was, double factor, const char* unit,
                       const char* words) {
    if (const auto by = difference(calibration, quantity, was))
      parts.push_back(filled(words, *by, with_unit(*by * factor, unit)));
  };
  add(BaseQuantity::lidar_x, stated[0], 1000.0, "mm", "{} further [ahead|back]");
  add(BaseQuantity::lidar_y, stated[1], 1000.0, "mm", "{} further to the [left|right]");
  add(BaseQuantity::lidar_yaw, stated[2], kDegrees, "degrees", "turned {} further to the [left|right]");
  if (parts.empty()) return;
  std::string words = "lidar ";
  for (std::size_t k = 0; k < parts.size(); ++k)
    words += (k == 0 ? "" : k + 1 == parts.size() ? " and " : ", ") + parts[k];
  findings.push_back({Spot::lidar, words + " than stated",
                      "mount of the lidar, where it should sit as stated", "the new pose corrects it"});
}

}  // namespace

std::string plain_number(double value) {
  const double size = std::abs(value);
  if (!std::isfinite(size)) return "-";
  if (size >= settings::kWholeNumbers) return fmt::format("{:.0f}", size);
  if (size >= settings::kTenths) return fmt::format("{:.1f}", size);
  return fmt::format("{:.1g}", size);
}

Display display_of(const std::string& effect, const std::string& parameter, const Quantity& quantity) {
  const ParameterMeaning* meaning = meaning_of(effect, parameter);
  if (meaning == nullptr) return display_of(quantity.unit);
  return {meaning->factor, std::string(meaning->unit), settings::kDigits};
}

std::string label_of(const std::string& effect, const std::string& parameter) {
  const ParameterMeaning* meaning = meaning_of(effect, parameter);
  const std::string label = meaning == nullptr ? readable(parameter) : std::string(meaning->label);
  return readable(effect) + (label.empty() ? "" : ": " + label);
}

std::vector<Gain> gains_of(const Calibration& calibration, const ReportData& data) {
  const auto nominal = nominal_errors(calibration);
  std::vector<Gain> gains;
  const auto add = [&](const char* name, const char* what, const char* unit, double factor,
                       double by_dimensions, const char* more, const char* less) {
    for (const DriveError& error : data.drive_errors) {
      if (error.name != name) continue;
      Gain gain{what, unit, std::nullopt, std::nullopt, ""};
      if (error.before) gain.before = factor * error.before->value;
      if (error.after) gain.after = factor * error.after->value;
      if (gain.before) gain.way = direction(by_dimensions, *gain.before, more, less);
      gains.push_back(std::move(gain));
    }
  };
  add("straight_metre_length", "a metre", "mm", 1000.0, nominal ? nominal->metre_mm : 0.0, "too long",
      "too short");
  add("full_turn_heading", "a full turn", "degrees", kDegrees, nominal ? nominal->turn_deg : 0.0, "too large",
      "too small");
  if (gains.empty()) add("open_loop_10s_position", "after ten seconds odometry", "mm", 1000.0, 0.0, "", "");
  return gains;
}

std::string gain_sentence(const Calibration& calibration, const ReportData& data) {
  const char* now = calibration.verdict == Verdict::refused ? ", by the refused values " : ", now ";
  std::string out;
  for (const Gain& gain : gains_of(calibration, data)) {
    const auto size = [&](const std::optional<double>& value) { return with_unit(*value, gain.unit); };
    std::string words = gain.what;
    if (gain.before)
      words += (gain.way.empty() ? " was " + size(gain.before) + " off"
                                 : " read " + size(gain.before) + " " + gain.way);
    if (gain.after) words += (gain.before ? now : " is ") + size(gain.after) + " off";
    out += (out.empty() ? "" : "; ") + words;
  }
  if (out.empty()) return out;
  out[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(out[0])));
  return out + ".";
}

std::vector<Finding> dimension_findings(const Calibration& calibration) {
  std::vector<Finding> findings;
  add_length(calibration, BaseQuantity::left_wheel_diameter, Spot::left_wheel,
             "left wheel {} [larger|smaller] than stated", findings);
  add_length(calibration, BaseQuantity::right_wheel_diameter, Spot::right_wheel,
             "right wheel {} [larger|smaller] than stated", findings);
  add_length(calibration, BaseQuantity::track_width, Spot::axle,
             "wheels {} [further apart|closer together] than stated", findings);
  add_lidar(calibration, findings);
  return findings;
}

std::vector<Finding> effect_findings(const Calibration& calibration) {
  std::vector<Finding> all;
  for (const EffectResult& effect : calibration.effects) {
    auto found = findings_of(calibration, effect);
    std::move(found.begin(), found.end(), std::back_inserter(all));
  }
  return all;
}

std::vector<std::string> effect_lines(const Calibration& calibration) {
  std::vector<std::string> lines;
  std::string before;
  for (const Finding& one : effect_findings(calibration)) {
    const std::string end = " (" + one.remedy + ")";
    if (one.remedy == before)
      lines.back().replace(lines.back().size() - end.size(), end.size(), ", " + one.what + end);
    else
      lines.push_back(one.what + end);
    before = one.remedy;
  }
  return lines;
}

}  // namespace odomcalib::cli
