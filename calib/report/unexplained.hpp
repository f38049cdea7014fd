// What stays without a name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/report/findings.hpp"
#include "calib/selection/outlier_trace.hpp"

namespace odomcalib::calib::report {

/// Smooth terms without a name, of the lidar and of the wheels: covariates they depend on, in the order
/// found.
std::optional<Unexplained> unnamed_smooths(const Findings& found);

/// Where the only finding of a recording is what goes with its outliers: a defect that is not compensated.
std::optional<Unexplained> flagged_outliers(const selection::OutlierTrace& outliers);

/// What goes with odometry's error although no function of it predicts anything: it is not compensated.
std::optional<Unexplained> failed_validation(const selection::SearchResult& outcome);

}  // namespace odomcalib::calib::report
