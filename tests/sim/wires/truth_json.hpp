// True values of the simulated robot, for people and scripts that check a calibration against them.
#pragma once

#include <filesystem>
#include <string>

#include "proto/result.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/wires/sim_robot.hpp"

namespace odomcalib::sim {

/// Names and units as in the calibration file (m, rad), plus the pose at this moment and the ports.
std::string truth_json(const SimRobot& robot, const DrawnEffect& effect = {});
/// Written beside and renamed, so that a reader never sees half of it.
Result<void> write_truth(const SimRobot& robot, const std::filesystem::path& path,
                         const DrawnEffect& effect = {});

}  // namespace odomcalib::sim
