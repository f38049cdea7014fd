#include "calib/selection/tracing_json.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <variant>

#include "calib/terms/curve.hpp"

namespace odomcalib::calib::selection {
namespace {

template <typename Enum>
std::optional<Enum> enum_from(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  return std::nullopt;
}

/// Members of a curve's entry that belong to its basis; what the file does not say has its usual value.
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
bool is_sound(const Shape& shape, vehicle::Variable variable) {
  const bool is_of_time = shape.moment != 0.0 || shape.fading != 0.0;
  return shape.knots >= terms::kKnots && shape.knots <= terms::kMostKnots &&
         shape.degree >= terms::kPlainest && shape.degree <= terms::kDegrees && shape.moment >= 0.0 &&
         shape.fading >= 0.0 && (!is_of_time || variable == vehicle::Variable::time);
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

std::optional<FittedCurve> curve_from(const nlohmann::json& entry) {
  if (!entry.is_object()) return std::nullopt;
  const auto variable = enum_from(entry.value("variable", ""), vehicle::kLastVariable);
  const auto carrier = enum_from(entry.value("carrier", ""), vehicle::kLastCarrier);
  if (!variable || !carrier) return std::nullopt;
  const auto memory = entry.value("memory", vehicle::kUsualMemory);
  const Shape shape = shape_from(entry);
  if (memory >= memories_of(*variable) || !is_sound(shape, *variable)) return std::nullopt;
  terms::Curve curve{{*variable, *carrier}, entry.value("low", 0.0), entry.value("high", 0.0), memory};
  curve.with_motion = entry.value("with_motion", false);
  curve.basis = basis_from(shape, curve.basis);
  const auto coefficients = entry.value("coefficients", std::vector<double>{});
  if (!(curve.high > curve.low) || coefficients.size() != function_count(curve)) return std::nullopt;
  curve.mean = entry.value("mean", std::vector<double>{});
  if (!curve.mean.empty() && curve.mean.size() != coefficients.size()) return std::nullopt;
  return FittedCurve{curve, coefficients, entry.value("law_of", "")};
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

std::string curves_to_json(const std::vector<FittedCurve>& curves) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [curve, coefficients, law_of] : curves) {
    const Shape shape = shape_of(curve.basis);
    list.push_back({{"variable", to_string(curve.law.variable)},
                    {"carrier", to_string(curve.law.carrier)},
                    {"low", curve.low},
                    {"high", curve.high},
                    {"period", shape.period},
                    {"mean", curve.mean},
                    {"harmonic", shape.harmonic},
                    {"knots", shape.knots},
                    {"degree", shape.degree},
                    {"moment", shape.moment},
                    {"fading", shape.fading},
                    {"memory", curve.memory},
                    {"wave", shape.wave},
                    {"constant", shape.constant},
                    {"patches", shape.patches},
                    {"with_motion", curve.with_motion},
                    {"coefficients", coefficients},
                    {"law_of", law_of}});
  }
  return list.dump();
}

std::vector<FittedCurve> curves_from_json(const std::string& text) {
  std::vector<FittedCurve> curves;
  try {
    const nlohmann::json list = nlohmann::json::parse(text);
    if (!list.is_array()) return curves;
    for (const auto& entry : list)
      if (auto curve = curve_from(entry)) curves.push_back(std::move(*curve));
  } catch (const nlohmann::json::exception&) {
    return curves;  // members of the wrong type: nothing after them is trusted
  }
  return curves;
}

}  // namespace odomcalib::calib::selection
