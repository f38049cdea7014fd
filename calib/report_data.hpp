// Fills what a report shows beyond the contract of the calibration file (proto/report_data.hpp).
#pragma once

#include <optional>

#include "calib/estimators/joint.hpp"
#include "calib/session/session.hpp"
#include "calib/tracing/search_result.hpp"
#include "proto/report_data.hpp"

namespace odomcalib::calib {

/// @param plain fit of the base parameters alone
ReportData make_report_data(const Session& session, const SearchResult& found,
                            const std::optional<FitResult>& plain);

}  // namespace odomcalib::calib
