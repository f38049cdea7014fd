// A comparison of calibrations as text or page, as CSV and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "daemon/cli/comparison.hpp"
#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// How much of it: the whole change and a line a step; each step in full; with pictures as well.
enum class Extent { summary, steps, page };
Document describe(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options, Extent extent);

/// One line a calibration and parameter, with what changed since the one before.
std::string to_csv(const std::vector<ComparedRobot>& robots);

/// Members of the document "comparison".
nlohmann::ordered_json to_json(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options);

}  // namespace odomcalib::cli
