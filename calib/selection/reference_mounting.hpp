// Where on the base a reference that states its poses is really mounted.
#pragma once

#include "calib/estimation/fit.hpp"

namespace odomcalib::calib::selection {

/// Poses of the base may be those of a marker beside the middle of the axle, which in turns looks like a base
/// that moves sideways: where it plainly sits elsewhere, its place is fitted, too. Any other fit, and one
/// that failed, goes on as it is.
estimation::Fit mount_reference(estimation::Fit fit, const estimation::Settling& how);

}  // namespace odomcalib::calib::selection
