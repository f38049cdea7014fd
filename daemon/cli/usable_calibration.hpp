// Calibration files whose values are about to be used, not only shown.
#pragma once

#include <optional>
#include <string>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// A calibration whose values are what their units say (wrong_value). Error: io, format, refused.
Result<Calibration> read_plausible_calibration(const std::string& path);
/// The same of one to be shown: without a value that is no number, and without a length that is none, unless
/// it was refused and says so.
Result<Calibration> read_sound_calibration(const std::string& path);
/// The same of one whose values are all finite.
Result<Calibration> read_finite_calibration(const std::string& path);

/// Wheel diameters and track width, as they are needed to drive by. Error: refused, when the file says so
/// itself; format, when one is missing or no length.
struct Dimensions {
  double left, right, track;
  [[nodiscard]] double mean() const { return 0.5 * (left + right); }
};
Result<Dimensions> dimensions_of(const Calibration& calibration, const std::string& where);

/// Counts of the encoder; none where the recordings hold the motion as something else and nobody stated any.
std::optional<double> counts_a_turn(const Calibration& calibration);

/// "refused: why", as the error of whoever will not use it.
Error refusal_of(const Calibration& calibration, const std::string& where);

}  // namespace odomcalib::cli
