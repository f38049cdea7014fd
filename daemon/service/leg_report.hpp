// What came of the moves of a motion, beside its recording.
#pragma once

#include <array>

#include "daemon/service/motion_run.hpp"
#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// Turns of the left and the right wheel during a move, rad.
std::array<double, 2> wheel_turns(const Leg& leg, double ticks_per_rev);

/// {"moves": [...], "robot": {...}}: wheels, odometry and lidar of each move, all from rest to rest, and the
/// values that odometry goes by. With `moves_in_round` also "rounds": odometry and lidar from the begin to
/// the end of so many moves.
ordered_json moves_report(const Bench& bench, const std::vector<Leg>& legs, std::size_t moves_in_round);

}  // namespace odomcalib
