// Dead reckoning of a recording with a calibration and its host-side effects.
#pragma once

#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/measurements.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::odometry {

/// Base pose at each tick sample, starting at the origin. Frame: base at the first sample. What changed with
/// time is followed where the stamps are on the clock of the calibration's own drive (DriveClock). Speeds are
/// taken from the samples before and after each.
std::vector<PoseSample> predict(const Recording& recording, const Calibration& calibration);

/// The same as the running daemon and the library have it: each pose from the samples up to its own, with the
/// stamps that these came with. Effects that act by speeds see them a little later and with more noise.
std::vector<PoseSample> predict_live(const Recording& recording, const Calibration& calibration);

}  // namespace odomcalib::calib::odometry
