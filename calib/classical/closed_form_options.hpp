// How the closed form cuts outliers; its published settings by default.
#pragma once

namespace odomcalib::calib::classical {

struct ClosedFormOptions {
  int rounds = 4;               ///< outlier rounds; 0 keeps all samples
  double drop_fraction = 0.01;  ///< share cut per round, separately by position and by heading error
};

}  // namespace odomcalib::calib::classical
