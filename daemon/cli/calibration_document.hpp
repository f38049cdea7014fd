// A calibration for people: verdict first, then parameters, estimators, residuals, data.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/document.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// All of it, as text.
/// @param written what write_back_sections() says of it
Document describe(const Calibration& calibration, const std::vector<Section>& written = {});

// Parts of it, for whoever shows less, or folds it.
Section verdict_section(const Calibration& calibration);
/// Error of odometry before and now, in a sentence; no line where it is not known.
Section gain_section(const Calibration& calibration);
Section parameters_section(const Calibration& calibration);
Section effects_section(const Calibration& calibration);
/// Everything that a page does not show first, in groups with their titles; nothing empty.
/// @param written as of describe()
std::vector<std::pair<std::string, std::vector<Section>>> folded_sections(
    const Calibration& calibration, const std::vector<Section>& written = {});

/// "ACCEPTED", "ACCEPTED WITH WARNINGS" or "REFUSED".
std::string headline(Verdict verdict);
Document::Tone tone_of(Verdict verdict);
std::string next_step(const Calibration& calibration);

/// Settings of the run; empty where the file does not state them.
SolveSettings settings_of(const Calibration& calibration);
/// The metre "true to" stands on: "tape" or "lidar", by its data sheet; empty where nothing is known of it.
std::string metre_of(const Calibration& calibration);

}  // namespace odomcalib::cli
