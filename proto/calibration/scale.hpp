// The metre of the reference: how many true metres one of its metres is, and how well that is known. Member
// `scale` of the calibration file.
#pragma once

#include <string>

#include "proto/result.hpp"

namespace odomcalib {

struct Scale {
  double value = 1.0;  ///< lengths of the reference were multiplied by it
  double std = 0.0;    ///< standard deviation
  std::string source;  ///< "lidar data sheet", "tape" or "stated"
};

struct Quantity;
/// Standard deviation of a length in true metres: `std`, which is against the reference's own metre, and that
/// of the metre, in quadrature (JCGM 100:2008, 5.1.2: the two have nothing in common). Of an angle, or of
/// what is not estimated, `std` itself.
double absolute_deviation(const Quantity& quantity, const Scale& scale);

/// "1.002+-0.001", with the deviation, or "1.002" with none. Errors: usage (no such numbers; not between 0.5
/// and 2; a deviation that is negative or above 0.1).
Result<Scale> scale_from_text(const std::string& text);

}  // namespace odomcalib
