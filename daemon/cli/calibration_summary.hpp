// Summary of a calibration, for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/cli/document.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Verdict with its reasons, values, errors before and after, what was found: at most settings::kSummaryLines
/// lines as long as the tables leave room. Remarks on values and effects give way first, then all reasons but
/// the first few.
/// @param width columns of a line
std::string summary(const Calibration& calibration, bool legend, std::size_t width);

/// The summary, or with --verbose everything, on standard output.
/// @param written what write_back_sections() says of it; no part of the summary
void print_calibration(const Calibration& calibration, const Session& session,
                       const std::vector<Section>& written = {});

}  // namespace odomcalib::cli
