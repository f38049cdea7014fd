// How the sensor moves while its beam goes round.
#pragma once

#include "calib/matching/surface.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

/// Motion by odometry from the middle of the sweep, linear between poses every few milliseconds.
/// @param mount of the sensor on the base
/// @return motion that refers to neither argument; none when the recording lacks the beams' times
matching::BeamMotion motion_in_sweep(const vehicle::Trajectory& trajectory, const math::Pose& mount,
                                     const Scan& scan);

}  // namespace odomcalib::calib::measurement
