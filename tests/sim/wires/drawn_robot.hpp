// The robot of demonstrations: its dimensions, its noise and what the plain model lacks follow from one
// number.
#pragma once

#include <cstdint>
#include <string>

#include "tests/sim/effects/effect.hpp"
#include "tests/sim/wires/sim_robot.hpp"

namespace odomcalib::sim {

/// @param name of an effect; "random": one drawn; any other: none
/// @param size in its unit; negative: its largest usual size
DrawnEffect choose_effect(const std::string& name, std::uint64_t seed, double size = -1.0);

/// True dimensions differ from the nominal ones as draw_truth() has it; furnished room, a little slip.
SimRobotOptions drawn_robot(std::uint64_t seed, const DrawnEffect& effect);

}  // namespace odomcalib::sim
