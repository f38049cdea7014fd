// Whether poses of the reference, and those of odometry, look where they go: a base on two wheels moves along
// its heading, ahead or back.
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

/// The mistake in x, y or yaw without which poses move along their heading; nullopt when they do, hardly move
/// or no mistake of the table explains it. A frame with z down (north-east-down) moves along its heading too:
/// only the wheels contradict it. Error: format.
std::optional<Error> wrong_pose_frame(const Recording& recording);

/// The same of odometry that told the motion of the wheels.
std::optional<Error> wrong_odometry_heading(const Recording& recording);

/// m, to the left of the middle of the axle, of a frame that goes ahead by so much for each radian of a turn
/// to the right, and back for each of one to the left: as a frame beside the axle does while the robot turns
/// on the spot. A robot that always turns about a point beside its middle does so too, so that another
/// witness has to confirm it. nullopt where turns both ways do not agree, of a distance that is small beside
/// the track, and of a recording whose wheel motion is not from odometry.
std::optional<double> beside_axle(const Recording& recording);

}  // namespace odomcalib::calib::ingest
