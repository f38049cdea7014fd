#include "calib/selection/tracing_json.hpp"

#include <nlohmann/json.hpp>
#include <optional>

#include "calib/terms/basis.hpp"

namespace odomcalib::calib::selection {
namespace {

template <typename Enum>
std::optional<Enum> enum_from(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  return std::nullopt;
}

/// A file may say anything.
bool is_sound(const terms::Curve& curve) {
  const bool has_shape_of_time = curve.moment != 0.0 || curve.fading != 0.0;
  return curve.high > curve.low && curve.memory < memories_of(curve.law.variable) &&
         curve.knots >= terms::kKnots && curve.knots <= terms::kMostKnots &&
         curve.degree >= terms::kPlainest && curve.degree <= terms::kDegrees && curve.moment >= 0.0 &&
         curve.fading >= 0.0 && (!has_shape_of_time || curve.law.variable == vehicle::Variable::time);
}

std::optional<FittedCurve> curve_from(const nlohmann::json& entry) {
  if (!entry.is_object()) return std::nullopt;
  const auto variable = enum_from(entry.value("variable", ""), vehicle::kLastVariable);
  const auto carrier = enum_from(entry.value("carrier", ""), vehicle::kLastCarrier);
  if (!variable || !carrier) return std::nullopt;
  terms::Curve curve{{*variable, *carrier},
                     entry.value("low", 0.0),
                     entry.value("high", 0.0),
                     entry.value("period", 0.0),
                     entry.value("harmonic", 0),
                     {},
                     entry.value("knots", terms::kKnots)};
  const auto coefficients = entry.value("coefficients", std::vector<double>{});
  curve.degree = entry.value("degree", terms::kDegrees);
  curve.moment = entry.value("moment", 0.0);
  curve.fading = entry.value("fading", 0.0);
  curve.memory = entry.value("memory", vehicle::kUsualMemory);
  curve.wave = entry.value("wave", curve.wave);
  curve.constant = entry.value("constant", false);
  curve.patches = entry.value("patches", false);
  curve.with_motion = entry.value("with_motion", false);
  if (!is_sound(curve) || coefficients.size() != basis_size(curve)) return std::nullopt;
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
  for (const auto& [curve, coefficients, law_of] : curves)
    list.push_back({{"variable", to_string(curve.law.variable)},
                    {"carrier", to_string(curve.law.carrier)},
                    {"low", curve.low},
                    {"high", curve.high},
                    {"period", curve.period},
                    {"mean", curve.mean},
                    {"harmonic", curve.harmonic},
                    {"knots", curve.knots},
                    {"degree", curve.degree},
                    {"moment", curve.moment},
                    {"fading", curve.fading},
                    {"memory", curve.memory},
                    {"wave", curve.wave},
                    {"constant", curve.constant},
                    {"patches", curve.patches},
                    {"with_motion", curve.with_motion},
                    {"coefficients", coefficients},
                    {"law_of", law_of}});
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
