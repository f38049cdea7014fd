#include "daemon/cli/usable_calibration.hpp"

#include "proto/base_quantities.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kRemedy = "solve the recording again";

}  // namespace

Result<Calibration> read_finite_calibration(const std::string& path) {
  auto calibration = read_calibration(path);
  if (!calibration) return calibration;
  if (const auto member = non_finite_value(calibration.value()))
    return Error{ErrorCode::format, "\"" + *member + "\" has no finite value", path, kRemedy};
  return calibration;
}

Result<Dimensions> dimensions_of(const Calibration& calibration, const std::string& where) {
  Dimensions out{};
  struct Wanted {
    BaseQuantity length;
    double* value;
  };
  for (const auto& [length, value] : {Wanted{BaseQuantity::left_wheel_diameter, &out.left},
                                      Wanted{BaseQuantity::right_wheel_diameter, &out.right},
                                      Wanted{BaseQuantity::track_width, &out.track}}) {
    const auto stated = calibration.parameter(length);
    if (!stated && calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
    if (!stated || !(*stated > 0.0))
      return Error{ErrorCode::format,
                   std::string("\"parameters.") + name_of(length) + "\" is no length above 0", where,
                   kRemedy};
    *value = *stated;
  }
  return out;
}

Error refusal_of(const Calibration& calibration, const std::string& where) {
  const std::string why = calibration.reasons.empty() ? "no reason is stated" : calibration.reasons.front();
  return {ErrorCode::refused, "this calibration was refused: " + why, where,
          "see odomcalibctl report; record again and solve"};
}

}  // namespace odomcalib::cli
