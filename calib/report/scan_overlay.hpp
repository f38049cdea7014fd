// Scans of a stretch of the drive from where odometry, before and after, says that they were taken: walls lie
// on each other, or do not.
#pragma once

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::report {

/// Scans of the block of 20 s with the most motion; parameters are fitted to the other blocks. Empty where
/// the reference is no scans, nothing was held out, or nobody stated nominal values.
std::vector<ScanTrace> scan_overlay(const measurement::Dataset& dataset, const vehicle::EffectList& effects,
                                    const estimation::FitResult& fit, const std::vector<bool>& fixed);

}  // namespace odomcalib::calib::report
