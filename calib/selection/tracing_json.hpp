// Curves in the calibration file: member "curves", a list of {variable, carrier, low, high,
// coefficients}.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calib/selection/search_result.hpp"
#include "calib/terms/curve.hpp"

namespace odomcalib::calib::selection {

inline constexpr const char* kCurvesMember = "curves";

struct FittedCurve {
  terms::Curve curve;
  std::vector<double> coefficients;
  std::string law_of;  ///< named effect whose law it completes; empty: nothing in the catalogue explains it
};

std::string considered_to_json(const std::vector<Considered>& considered);

std::string curves_to_json(const std::vector<FittedCurve>& curves);

/// Entries that are not understood are left out: a newer program's curve must not stop odometry.
std::vector<FittedCurve> curves_from_json(const std::string& text);

}  // namespace odomcalib::calib::selection
