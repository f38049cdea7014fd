// Why a calibration failed, where the recording itself shows it: only of what was refused or fits badly.
#pragma once

#include <span>

#include "proto/calibration/calibration.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

/// Where a mistake in the recordings is likelier than a bad drive, each recording is looked at without the
/// wheels (estimation/first_look.hpp). Where that names a mistake, the calibration is refused for it, and has
/// no value of the fit that it spoilt; otherwise it stays as it is.
Calibration explained(std::span<const Recording> recordings, Calibration calibration);

}  // namespace odomcalib::calib::report
