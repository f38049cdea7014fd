// Curves in the calibration file: member "unexplained_model", a list of {variable, carrier, low, high,
// coefficients}.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calib/tracing/curve.hpp"

namespace odomcalib::calib {

inline constexpr const char* kCurvesMember = "unexplained_model";

using FittedCurve = std::pair<Curve, std::vector<double>>;

std::string curves_to_json(const std::vector<FittedCurve>& curves);

/// Entries that are not understood are left out: a newer program's curve must not stop odometry.
std::vector<FittedCurve> curves_from_json(const std::string& text);

}  // namespace odomcalib::calib
