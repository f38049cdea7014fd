// Fills what a report shows beyond the contract of the calibration file (proto/report_data.hpp).
#pragma once

#include <optional>

#include "calib/estimators/joint.hpp"
#include "calib/session/session.hpp"
#include "proto/report_data.hpp"

namespace odomcalib::calib {

/// @param fit of the base parameters and `effects`; @param plain of the base parameters alone
ReportData make_report_data(const Session& session, const EffectList& effects, const FitResult& fit,
                            const std::optional<FitResult>& plain);

}  // namespace odomcalib::calib
