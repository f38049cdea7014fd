// Plan of a motion, before it is driven: the way, the space that it requires as a drawing with numbers,
// and what limits it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// @param plan result of a motion's method with `dry_run` (docs/schema/plan-1.json)
Document describe_plan(const nlohmann::ordered_json& plan);

}  // namespace odomcalib::cli
