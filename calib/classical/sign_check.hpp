// Do the wheels and the reference measure the same motion? Exchanged sides, counts that run backwards and a
// lidar that is upside down change nothing but signs, and signs need no fit to be seen.
#pragma once

#include <optional>
#include <span>

#include "calib/wheels/wheel_motion.hpp"
#include "proto/measurements.hpp"
#include "proto/recording/recording.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

/// Refused when wheels turned and the reference stood still, or when diameters and track width can be
/// positive only with wires exchanged or counts inverted; says which, as few as explain everything. When the
/// robot's lidar pose is known, a heading on the other side of it counts as one more fault. What a mirror
/// cannot separate (exchanged sides, a lidar upside down) is named together. nullopt also when the motion
/// does not determine the signs.
/// @param motions with any delay of the reference taken out
/// @param of_base the reference is the base itself, not a lidar
/// @param motion what told the motion of the wheels: odometry has no wires, but a frame
std::optional<Error> check_signs(std::span<const wheels::WheelMotion> motions, const RobotDescription& robot,
                                 bool of_base, MotionSource motion = MotionSource::ticks);

/// The second of these alone.
std::optional<Error> wrong_signs(std::span<const wheels::WheelMotion> motions, const RobotDescription& robot,
                                 bool of_base, MotionSource motion = MotionSource::ticks);

}  // namespace odomcalib::calib::classical
