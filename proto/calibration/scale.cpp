#include "proto/calibration/scale.hpp"

#include <cmath>
#include <optional>
#include <string_view>

#include "proto/calibration/calibration.hpp"
#include "proto/number_text.hpp"

namespace odomcalib {
namespace {

/// Beyond these a number is no scale of a reference but a unit, or a slip of the pen. Chosen.
constexpr double kLeast = 0.5, kMost = 2.0, kMostDeviation = 0.1;

}  // namespace

double absolute_deviation(const Quantity& quantity, const Scale& scale) {
  if (quantity.unit != "m" || !(quantity.std >= 0.0)) return quantity.std;
  return std::hypot(quantity.std, quantity.value * scale.std / scale.value);
}

Result<Scale> scale_from_text(const std::string& text) {
  constexpr std::string_view kBetween = "+-";
  const std::size_t at = text.find(kBetween);
  const std::string_view all = text;
  const auto value = number_from<double>(all.substr(0, at));
  const auto deviation =
      at == std::string::npos ? std::optional(0.0) : number_from<double>(all.substr(at + kBetween.size()));
  const bool is_scale = value && deviation && *value >= kLeast && *value <= kMost && *deviation >= 0.0 &&
                        *deviation <= kMostDeviation;
  if (!is_scale)
    return Error{
        ErrorCode::usage, "\"" + text + "\" is no scale of a reference", "--scale",
        "state what a tape says over what the reference says, and its standard deviation: 1.002+-0.001"};
  return Scale{*value, *deviation, "stated"};
}

}  // namespace odomcalib
