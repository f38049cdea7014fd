// A calibration as a page: what its owner asks first on the first screen and on the first sheet of paper,
// everything else folded below.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/document.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Self-contained, without scripts. On paper everything is unfolded, and the first sheet is the summary.
/// @param written what write_back_sections() says of it; it is folded, too
std::string report_page(const Calibration& calibration, const std::vector<Section>& written = {});

/// "carrier-17 · hall 3 · driven 2026-11-29, 10:25 to 10:29 UTC", as far as it is known; otherwise the names
/// of the recordings.
std::string subject_line(const Calibration& calibration);

}  // namespace odomcalib::cli
