// When the beams of a scan were sent, where its stamp says something else or not enough.
#pragma once

#include "calib/estimation/fit.hpp"

namespace odomcalib::calib::selection {

/// Scans that were taken evenly and stamped unevenly are measured anew, at even times. Any other fit, and one
/// that failed, goes on as it is.
estimation::Fit even_out_scans(estimation::Fit fit, const estimation::Settling& how);

/// Scans that do not say when each beam was sent are taken for sweeps of a turning head if that explains the
/// motion clearly better. Any other fit, and one that failed, goes on as it is.
/// @param request that the fit began with
estimation::Fit let_scans_sweep(estimation::Fit fit, const terms::Request& request,
                                const estimation::Settling& how);

}  // namespace odomcalib::calib::selection
