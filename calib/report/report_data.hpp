// Fills what a report shows beyond the contract of the calibration file (proto/report_data.hpp).
#pragma once

#include <optional>

#include "calib/estimation/joint.hpp"
#include "calib/measurement/dataset.hpp"
#include "calib/selection/search_result.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::report {

/// @param plain fit of the base parameters alone
ReportData make_report_data(const measurement::Dataset& dataset, const selection::SearchResult& found,
                            const std::optional<estimation::FitResult>& plain);

}  // namespace odomcalib::calib::report
