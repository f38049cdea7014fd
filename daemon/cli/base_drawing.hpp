// The base of a robot from above, with numbers where something was found.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/plain_words.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Inline SVG, to scale: wheels, lidar where it was found and where it was stated. Findings are numbered from
/// one in their order.
std::string base_drawing(const Calibration& calibration, const std::vector<Finding>& findings);

}  // namespace odomcalib::cli
