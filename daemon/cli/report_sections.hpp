// The sections of a report that stand on the calibration file's additive members.
#pragma once

#include "daemon/cli/document.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/figures.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {

// Sections without lines and rows have nothing to say.
/// @param intervals whether they are shown beside the figures, where there are stretches enough
Section drive_errors_section(const Calibration& calibration, const ReportData& data, bool intervals);
Section traces_section(const ReportData& data);
/// Every other effect, and the size at which it shows; the drive that would test it, where this one is no
/// test.
/// @param meanings whether a column says what each is, for which a terminal has no room
Section not_found_section(const ReportData& data, bool meanings);
/// Meanings of the effects that were found.
Section meanings_section(const Calibration& calibration);
inline constexpr const char* kDriveTitle = "The drive";
Section path_section(const ReportData& data);
Section determination_section(const Calibration& calibration);
Section repeatability_section(const Calibration& calibration, const ReportData& data);
Section residual_shape_section(const ReportData& data);
/// Numbers of the file that need no words but their label.
Section further_figures_section(const std::vector<LabelledFigure>& figures);
/// Notes, settings, versions: member "settings".
Section settings_section(const Calibration& calibration);
Section reading_section();

}  // namespace odomcalib::cli
