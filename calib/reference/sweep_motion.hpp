// How the sensor moves while its beam goes round.
#pragma once

#include "calib/matching/surface.hpp"
#include "calib/model/drive_model.hpp"
#include "proto/recording.hpp"

namespace odomcalib::calib {

/// Motion by odometry from the middle of the sweep, linear between poses every few milliseconds.
/// @param mount of the sensor on the base
/// @return motion that refers to neither argument; none when the recording does not tell the beams' times
BeamMotion motion_in_sweep(const Trajectory& trajectory, const Pose& mount, const Scan& scan);

}  // namespace odomcalib::calib
