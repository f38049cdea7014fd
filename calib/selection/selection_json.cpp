#include "calib/selection/selection_json.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <variant>

#include "calib/math/number_text.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {
namespace {

template <typename Enum>
std::optional<Enum> enum_from(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  return std::nullopt;
}

/// Members of a smooth term's entry that belong to its basis; what the file does not say has its usual value.
struct Shape {
  double period = 0.0;
  int harmonic = 0, knots = terms::kKnots, degree = terms::kDegrees;
  double moment = 0.0, fading = 0.0;
  std::array<double, 2> wave{};
  bool constant = false, patches = false;
};

Shape shape_of(const terms::Basis& basis) {
  const auto as_shape = []<typename Kind>(const Kind& kind) {
    Shape shape;
    if constexpr (std::is_same_v<Kind, terms::Cycle>) shape.period = kind.period;
    if constexpr (std::is_same_v<Kind, terms::Harmonics>) shape.harmonic = kind.only;
    if constexpr (std::is_same_v<Kind, terms::Harmonics>) shape.constant = kind.constant;
    if constexpr (std::is_same_v<Kind, terms::Splines>) shape.knots = kind.knots;
    if constexpr (std::is_same_v<Kind, terms::Polynomials>) shape.degree = kind.degree;
    if constexpr (std::is_same_v<Kind, terms::ChangePoint>) shape.moment = kind.moment;
    if constexpr (std::is_same_v<Kind, terms::Decay>) shape.fading = kind.time_constant;
    if constexpr (std::is_same_v<Kind, terms::Wave>) shape.wave = {kind.along_x, kind.along_y};
    shape.patches = std::is_same_v<Kind, terms::Patches>;
    return shape;
  };
  return std::visit(as_shape, basis);
}

Shape shape_from(const nlohmann::json& entry) {
  Shape shape;
  shape.period = entry.value("period", shape.period);
  shape.harmonic = entry.value("harmonic", shape.harmonic);
  shape.knots = entry.value("knots", shape.knots);
  shape.degree = entry.value("degree", shape.degree);
  shape.moment = entry.value("moment", shape.moment);
  shape.fading = entry.value("fading", shape.fading);
  shape.wave = entry.value("wave", shape.wave);
  shape.constant = entry.value("constant", shape.constant);
  shape.patches = entry.value("patches", shape.patches);
  return shape;
}

/// A file may say anything.
bool is_sound(const Shape& shape, vehicle::Covariate covariate) {
  const bool is_of_time = shape.moment != 0.0 || shape.fading != 0.0;
  return shape.knots >= terms::kKnots && shape.knots <= terms::kMostKnots &&
         shape.degree >= terms::kPlainest && shape.degree <= terms::kDegrees && shape.moment >= 0.0 &&
         shape.fading >= 0.0 && (!is_of_time || covariate == vehicle::Covariate::time);
}

/// The basis with what the file says of it.
terms::Basis basis_from(const Shape& shape, const terms::Basis& usual) {
  if (std::holds_alternative<terms::Sway>(usual)) return usual;
  if (shape.constant) return terms::Harmonics{0, true};
  if (shape.period > 0.0) return terms::Cycle{shape.period};
  if (std::holds_alternative<terms::Harmonics>(usual)) return terms::Harmonics{std::max(shape.harmonic, 0)};
  if (shape.moment > 0.0) return terms::ChangePoint{shape.moment};
  if (shape.fading > 0.0) return terms::Decay{shape.fading};
  if (std::holds_alternative<terms::Surface>(usual)) {
    if (shape.wave != std::array<double, 2>{}) return terms::Wave{shape.wave[0], shape.wave[1]};
    return shape.patches ? terms::Basis(terms::Patches{}) : usual;
  }
  const bool is_smooth =
      std::holds_alternative<terms::Polynomials>(usual) || std::holds_alternative<terms::SpeedHats>(usual);
  if (is_smooth && shape.knots > terms::kKnots) return terms::Splines{shape.knots};
  return std::holds_alternative<terms::Polynomials>(usual) ? terms::Polynomials{shape.degree} : usual;
}

std::optional<FittedSmoothTerm> smooth_from(const nlohmann::json& entry) {
  if (!entry.is_object()) return std::nullopt;
  const auto covariate = enum_from(entry.value("variable", ""), vehicle::kLastCovariate);
  const auto channel = enum_from(entry.value("carrier", ""), vehicle::kLastChannel);
  if (!covariate || !channel) return std::nullopt;
  const auto memory = entry.value("memory", vehicle::kUsualMemory);
  const Shape shape = shape_from(entry);
  if (memory >= memories_of(*covariate) || !is_sound(shape, *covariate)) return std::nullopt;
  terms::SmoothTerm smooth{{*covariate, *channel}, entry.value("low", 0.0), entry.value("high", 0.0), memory};
  smooth.with_motion = entry.value("with_motion", false);
  smooth.basis = basis_from(shape, smooth.basis);
  const auto coefficients = entry.value("coefficients", std::vector<double>{});
  if (!(smooth.high > smooth.low) || coefficients.size() != function_count(smooth)) return std::nullopt;
  smooth.mean = entry.value("mean", std::vector<double>{});
  if (!smooth.mean.empty() && smooth.mean.size() != coefficients.size()) return std::nullopt;
  return FittedSmoothTerm{smooth, coefficients, entry.value("law_of", "")};
}

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

std::string smooth_terms_to_json(const std::vector<FittedSmoothTerm>& smooths) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [smooth, coefficients, named_term] : smooths) {
    const Shape shape = shape_of(smooth.basis);
    list.push_back({{"variable", to_string(smooth.dependence.covariate)},
                    {"carrier", to_string(smooth.dependence.channel)},
                    {"low", smooth.low},
                    {"high", smooth.high},
                    {"period", shape.period},
                    {"mean", smooth.mean},
                    {"harmonic", shape.harmonic},
                    {"knots", shape.knots},
                    {"degree", shape.degree},
                    {"moment", shape.moment},
                    {"fading", shape.fading},
                    {"memory", smooth.memory},
                    {"wave", shape.wave},
                    {"constant", shape.constant},
                    {"patches", shape.patches},
                    {"with_motion", smooth.with_motion},
                    {"coefficients", coefficients},
                    {"law_of", named_term}});
  }
  return list.dump();
}

std::vector<FittedSmoothTerm> smooth_terms_from_json(const std::string& text) {
  std::vector<FittedSmoothTerm> smooths;
  try {
    const nlohmann::json list = nlohmann::json::parse(text);
    if (!list.is_array()) return smooths;
    for (const auto& entry : list)
      if (auto smooth = smooth_from(entry)) smooths.push_back(std::move(*smooth));
  } catch (const nlohmann::json::exception&) {
    return smooths;  // members of the wrong type: nothing after them is trusted
  }
  return smooths;
}

std::string event_to_text(const FittedSmoothTerm& event, const math::Pose& mount) {
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
