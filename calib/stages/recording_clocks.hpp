// Each recording's own clock of the sensor, where it was set anew or aligned by hand from one recording to
// the next.
#pragma once

#include "calib/estimation/fit.hpp"
#include "calib/terms/request.hpp"

namespace odomcalib::calib::stages {

/// Where the clocks of several recordings differ beyond chance (Cochran's test), the reference of each gets
/// stamps on the clock that all have in common, and the model is fitted again. What a recording's clock
/// deviates by is shrunk by what chance has in it (B. Efron, C. Morris, J. Am. Stat. Assoc. 70, 1975, with
/// the variance between recordings of DerSimonian and Laird). Any other fit, one of effects that were
/// requested by name, and one that failed, goes on as it is.
/// @param request that the fit began with
estimation::Fit align_clocks(estimation::Fit fit, const terms::Request& request,
                             const estimation::Settling& how);

}  // namespace odomcalib::calib::stages
