// Scan matching that does not depend on which of the two scans is the reference.
#pragma once

#include "calib/matching/point_to_line.hpp"

namespace odomcalib::calib::matching {

/// Mean of the match of `second` with the lines of `first` and of `first` with those of `second`. Lines
/// fitted to a curved wall or across a corner lie on its inner side and readings do not, so that a single
/// match is off by the same amount and in the same direction in the sensor's frame whichever way the robot
/// went: where a lidar does not see all round, that does not cancel. The way back is off the opposite way (a
/// symmetric objective, after Rusinkiewicz: A symmetric objective function for ICP, ACM Trans. Graph. 38(4),
/// 2019). The information is that of both together; everything else, and all where the way back fails, is
/// that of the first match.
/// @param guess, result motion from `first` to `second`
MatchResult match_both_ways(const MatchReference& first, const MatchReference& second,
                            const math::Pose& guess, const MatchOptions& options);

}  // namespace odomcalib::calib::matching
