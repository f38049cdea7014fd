// Whether poses that a robot computed from its wheels can be those of two wheels.
#pragma once

#include <optional>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Two wheels move the middle of their axle along its heading. What goes sideways is, step by step, fitted by
/// a share of the way (a frame that is turned), of the turn (a frame ahead of the axle, which does no harm)
/// and of their product (the heading that the program moved along, of the begin or the end of the step).
/// Error: format, of a frame that is turned, and of a yaw and a place that different sources tell. nullopt
/// where neither is, and of a recording whose wheel motion is not from odometry.
std::optional<Error> wrong_odometry_frame(const Recording& recording);

}  // namespace odomcalib::calib::ingest
