// Curves that are worth asking for, and the other shapes of one that was found.
#pragma once

#include <span>
#include <vector>

#include "calib/terms/curve.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// Curves worth trying on this data: every sensible (variable, carrier) whose variable varies, on its 0.5 to
/// 99.5 % range, higher harmonics of the wheels, and periods of time between 8 s and two thirds of the
/// recording.
std::vector<Curve> candidate_curves(std::span<const vehicle::DriveModel* const> models);

/// The same law in other shapes: splines more or less smooth, other ways to understand what happened before.
std::vector<Curve> other_shapes(const Curve& curve, std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
