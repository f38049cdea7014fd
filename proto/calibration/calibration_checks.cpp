#include <cmath>

#include "proto/calibration/calibration.hpp"

namespace odomcalib {
namespace {

std::optional<std::string> non_finite(const QuantityList& quantities, const std::string& path) {
  for (const auto& [name, quantity] : quantities)
    if (!std::isfinite(quantity.value)) return std::string(path).append(".").append(name);
  return std::nullopt;
}

}  // namespace

std::optional<std::string> non_finite_value(const Calibration& calibration) {
  if (auto path = non_finite(calibration.parameters, "parameters")) return path;
  for (const EffectResult& effect : calibration.effects)
    if (auto path = non_finite(effect.parameters, "effects." + effect.name)) return path;
  return std::nullopt;
}

}  // namespace odomcalib
