// What may be requested of solve: effects by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::calib::terms {

/// In a fixed order, each once: effects of wheels, clocks and floor, then of the lidar.
std::vector<std::string> effect_names();

/// Why SolveOptions::effects makes no sense, with the names that there are; nullopt when it does: "auto" or
/// "none" alone, or known names, each once.
std::optional<Error> wrong_effects(const std::vector<std::string>& wanted);

}  // namespace odomcalib::calib::terms
