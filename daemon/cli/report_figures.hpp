// The pictures of a report, from the points that the calibration file carries.
#pragma once

#include "daemon/cli/document.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {

/// @param has_effects whether odometry without effects is drawn too
Figure figure_of_growth(const std::vector<ErrorGrowth>& growth, bool has_effects);
Figure figure_of_paths(const std::vector<PathTrace>& paths);
/// Scans of one stretch, from where odometry before and after says that they were taken.
Figure figure_of_scans(const std::vector<ScanTrace>& scans);
Figure figure_of_trace(const ResidualTrace& trace);
/// Normalised residual over time and as a histogram.
std::vector<Figure> figures_of_residual(const ReportData& data);

}  // namespace odomcalib::cli
