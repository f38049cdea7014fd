// What came of the moves of a motion, beside its recording.
#pragma once

#include "daemon/service/motion_run.hpp"
#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// {"moves": [...]}: odometry and lidar of each move, both from rest to rest.
ordered_json moves_report(const Bench& bench, const std::vector<Leg>& legs);

}  // namespace odomcalib
