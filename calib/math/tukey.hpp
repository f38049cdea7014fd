// Tukey's biweight: residuals far out count nothing (Beaton and Tukey, Technometrics 16, 1974).
#pragma once

namespace odomcalib::calib::math {

/// Robust sigmas at which the weight reaches 0: 95 % efficiency at the normal distribution.
inline constexpr double kTukeyCut = 4.685;

/// Mean weight of normal residuals over that efficiency: weights divided by it add up to the information that
/// the residuals hold.
inline constexpr double kTukeyMeanWeight = 0.963;

/// @param share the residual over kTukeyCut robust sigmas
/// @return 1 at 0, 0 from 1 on
inline double tukey_weight(double share) {
  const double root = 1.0 - share * share;
  return root > 0.0 ? root * root : 0.0;
}

}  // namespace odomcalib::calib::math
