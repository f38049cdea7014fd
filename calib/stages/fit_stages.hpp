// Stages of the fit: when the beams of a scan were sent, where its stamp says something else or not enough;
// where on the base a reference that states its poses is really mounted; and the delay between the clocks,
// which is fitted before anything else is known, and leaves where it turns out to be none.
#pragma once

#include "calib/estimation/fit.hpp"
#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::stages {

/// Scans that were taken evenly and stamped unevenly are measured anew, at even times. Any other fit, and one
/// that failed, goes on as it is.
estimation::Fit choose_scan_stamps(estimation::Fit fit, const estimation::Settling& how);

/// Scans that do not say when each beam was sent are taken for sweeps of a turning head if that explains the
/// motion clearly better. Any other fit, and one that failed, goes on as it is.
/// @param request that the fit began with
estimation::Fit choose_sweep_timing(estimation::Fit fit, const terms::Request& request,
                                    const estimation::Settling& how);

/// Poses of the base may be those of a marker beside the middle of the axle, which in turns looks like a base
/// that moves sideways: where it plainly sits elsewhere, its place is fitted, too. Any other fit, and one
/// that failed, goes on as it is.
estimation::Fit mount_reference(estimation::Fit fit, const estimation::Settling& how);

/// How all fits of the pipeline settle.
/// @param may_prune clocks were not requested by name: those that run alike are left out
estimation::Settling settling(bool may_prune, const measurement::Progress& progress);

/// The model without parts of the clock that are idle (criterion.hpp), as it is to be fitted next.
vehicle::VehicleModel without_idle_clocks(const estimation::Fit& fit);

/// An idle delay leaves the model, or stays without being reported where it is plain but short: what it stood
/// for may have got its own name.
selection::SearchResult without_idle_delay(const selection::FitTask& task, selection::SearchResult found);

}  // namespace odomcalib::calib::stages
