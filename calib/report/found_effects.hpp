// Effects that a solve found or was given, with their values and their evidence; and what stays without a
// name.
#pragma once

#include <optional>
#include <vector>

#include "calib/report/findings.hpp"
#include "calib/report/outlier_trace.hpp"
#include "calib/selection/file_entries.hpp"

namespace odomcalib::calib::report {

/// Effects of the lidar, of its stamps, and of the wheels, the clocks and the floor. Smooth terms have no
/// name and are not among them.
/// @param plain fit of the base parameters alone to the same pairs; nullopt where it failed
std::vector<EffectResult> found_effects(const Findings& found,
                                        const std::optional<estimation::FitResult>& plain);

std::vector<terms::FittedSmoothTerm> found_smooths(const Findings& found);

/// Smooth terms without a name, of the lidar and of the wheels: covariates they depend on, in the order
/// found.
std::optional<Unexplained> unnamed_smooths(const Findings& found);

/// Where the only finding of a recording is what goes with its outliers: a defect that is not compensated.
std::optional<Unexplained> flagged_outliers(const report::OutlierTrace& outliers);

/// Covariates that odometry's error goes with although no function of them predicts it: not compensated.
std::optional<Unexplained> failed_validation(const selection::SearchResult& outcome);

}  // namespace odomcalib::calib::report
