// Why a calibration failed, where the recording itself tells: asked only of what was refused or fits badly.
#pragma once

#include <span>

#include "proto/calibration/calibration.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::report {

/// Whether the result is such that a mistake in the recordings is likelier than a bad drive.
bool needs_explanation(const Calibration& calibration);

/// Looks at each recording without the wheels (estimation/first_look.hpp). Where that names a mistake, the
/// calibration is refused for it, and values of the fit that it spoilt are taken out.
void explain(std::span<const Recording> recordings, Calibration& calibration);

/// Refused for this reason; keeps what was measured, but no value of a fit.
void refuse_for(const Error& cause, Calibration& calibration);

}  // namespace odomcalib::calib::report
