#include "calib/tracing/curve_json.hpp"

#include <nlohmann/json.hpp>
#include <optional>

namespace odomcalib::calib {
namespace {

template <typename Enum>
std::optional<Enum> enum_from(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  return std::nullopt;
}

std::optional<FittedCurve> curve_from(const nlohmann::json& entry) {
  if (!entry.is_object()) return std::nullopt;
  const auto variable = enum_from(entry.value("variable", ""), Variable::since_reversal);
  const auto carrier = enum_from(entry.value("carrier", ""), Carrier::sideways);
  if (!variable || !carrier) return std::nullopt;
  const Curve curve{*variable, *carrier, entry.value("low", 0.0), entry.value("high", 0.0)};
  const auto coefficients = entry.value("coefficients", std::vector<double>{});
  if (!(curve.high > curve.low) || coefficients.size() != basis(curve, curve.low).size()) return std::nullopt;
  return FittedCurve{curve, coefficients};
}

}  // namespace

std::string curves_to_json(const std::vector<FittedCurve>& curves) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [curve, coefficients] : curves)
    list.push_back({{"variable", to_string(curve.variable)},
                    {"carrier", to_string(curve.carrier)},
                    {"low", curve.low},
                    {"high", curve.high},
                    {"coefficients", coefficients}});
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

}  // namespace odomcalib::calib
