// What a nudge of each wheel shows about the wiring.
#pragma once

#include "daemon/service/motion_run.hpp"
#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// {"checks": rows of `check` with one or more about the wiring, "wiring": what was measured}
ordered_json nudge_report(const Bench& bench, const std::vector<Leg>& legs);

}  // namespace odomcalib
