#include "daemon/cli/usable_calibration.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "calib/terms/catalogue.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/value_check.hpp"
#include "proto/recording/wheel_motion.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kRemedy = "solve the recording again";

/// In the order of kDriveLengths.
constexpr std::array<double Dimensions::*, kDriveLengths.size()> kDimensionMembers = {
    &Dimensions::left, &Dimensions::right, &Dimensions::track};

Error no_finite_value(const std::string& member, const std::string& where) {
  return {ErrorCode::format, "\"" + member + "\" has no finite value", where, kRemedy};
}

Error no_length(BaseQuantity length, const std::string& where) {
  return {ErrorCode::format, std::string("\"parameters.") + name_of(length) + "\" is no length above 0",
          where, kRemedy};
}

}  // namespace

Result<Calibration> read_plausible_calibration(const std::string& path) {
  auto calibration = read_calibration(path);
  if (!calibration) return calibration;
  if (auto wrong = wrong_value(calibration.value(), calib::terms::unit_of_effect, path)) return *wrong;
  return calibration;
}

Result<Calibration> read_finite_calibration(const std::string& path) {
  auto calibration = read_plausible_calibration(path);
  if (!calibration) return calibration;
  if (const auto member = non_finite_value(calibration.value())) return no_finite_value(*member, path);
  return calibration;
}

Result<Calibration> read_sound_calibration(const std::string& path) {
  auto calibration = read_plausible_calibration(path);
  if (!calibration || calibration.value().verdict == Verdict::refused) return calibration;
  if (const auto member = non_finite_value(calibration.value())) return no_finite_value(*member, path);
  for (const BaseQuantity length : kDriveLengths)
    if (const auto stated = calibration.value().parameter(length); stated && !(*stated > 0.0))
      return no_length(length, path);
  return calibration;
}

Result<Dimensions> dimensions_of(const Calibration& calibration, const std::string& where) {
  Dimensions out{};
  for (std::size_t k = 0; k < kDriveLengths.size(); ++k) {
    const BaseQuantity length = kDriveLengths[k];
    const auto stated = calibration.parameter(length);
    if (!stated && calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
    if (!stated || !(*stated > 0.0)) return no_length(length, where);
    out.*kDimensionMembers[k] = *stated;
  }
  return out;
}

std::optional<double> counts_a_turn(const Calibration& calibration) {
  const double counts = calibration.robot.ticks_per_rev;
  const auto is_made = [](const DataUse& data) {
    return std::any_of(data.choices.begin(), data.choices.end(),
                       [](const std::string& choice) { return choice.starts_with(kMotionFrom); });
  };
  const bool stand_for_none =
      counts == kFineCountsPerRev && std::any_of(calibration.data.begin(), calibration.data.end(), is_made);
  return counts > 0.0 && !stand_for_none ? std::optional(counts) : std::nullopt;
}

Error refusal_of(const Calibration& calibration, const std::string& where) {
  const std::string why = calibration.reasons.empty() ? "no reason is stated" : calibration.reasons.front();
  return {ErrorCode::refused, "this calibration was refused: " + why, where,
          "see odomcalibctl report; record again and solve"};
}

}  // namespace odomcalib::cli
