// Whether a solution may have a loop turned the wrong way round.
#pragma once

#include <cstddef>

#include "calib/slam/connectivity.hpp"

namespace odomcalib::calib::slam {

/// Loops (one for each edge outside a breadth-first tree) around which the heading errors add up to more than
/// half a turn. At a false minimum a whole turn is spread over a loop, a little on each edge, so that no edge
/// looks wrong by itself; added up it shows. Noise alone does that only in long, very noisy loops.
std::size_t loops_with_a_turn_too_much(const PoseGraph& graph, const Neighbours& neighbours,
                                       const Placement& at);

}  // namespace odomcalib::calib::slam
