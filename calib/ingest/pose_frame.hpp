// Whether reference poses look where they go: a base on two wheels moves along its heading, ahead or back.
#pragma once

#include <optional>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// The mistake in x, y or yaw without which poses move along their heading; nullopt when they do, hardly move
/// or no mistake of the table explains it. A frame with z down (north-east-down) moves along its heading too:
/// only the wheels contradict it. Error: format.
std::optional<Error> wrong_pose_frame(const Recording& recording);

/// The same of odometry that told the motion of the wheels.
std::optional<Error> wrong_odometry_heading(const Recording& recording);

}  // namespace odomcalib::calib::ingest
