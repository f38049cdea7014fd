// A calibration for people: verdict first, then parameters, estimators, residuals, data.
#pragma once

#include "daemon/cli/document.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

Document describe(const Calibration& calibration);

/// The same with an explanation for readers who have never seen one.
Document report(const Calibration& calibration);

// Parts of it, for whoever shows less.
Section verdict_section(const Calibration& calibration);
Section parameters_section(const Calibration& calibration);
Section effects_section(const Calibration& calibration);

/// "ACCEPTED", "ACCEPTED WITH WARNINGS" or "REFUSED".
std::string headline(Verdict verdict);

}  // namespace odomcalib::cli
