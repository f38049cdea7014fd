// The sections of a report that stand on the calibration file's additive members.
#pragma once

#include "daemon/cli/document.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {

/// What wrong dimensions did to odometry, in words; empty when nominal values are not known.
std::vector<std::string> effect_in_words(const Calibration& calibration);

// Sections without lines and rows have nothing to say.
/// @param intervals whether they are shown beside the figures
Section drive_errors_section(const ReportData& data, bool intervals);
Section traces_section(const ReportData& data);
Section detectable_section(const ReportData& data);
Section untested_section(const ReportData& data);
/// Of the effects in the sections above.
Section meanings_section(const Calibration& calibration, const ReportData& data);
inline constexpr const char* kDriveTitle = "The drive";
Section path_section(const ReportData& data);
Section determination_section(const Calibration& calibration);
Section repeatability_section(const Calibration& calibration, const ReportData& data);
Section residual_shape_section(const ReportData& data);
/// Notes, settings, versions: member "settings".
Section settings_section(const Calibration& calibration);
Section reading_section();

}  // namespace odomcalib::cli
