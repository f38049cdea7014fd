// Answers of the service, for people: its status, and the plan of a motion before it is driven.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// @param status as docs/schema/status-1.json has it
Document describe_status(const nlohmann::ordered_json& status);

/// @param plan result of a motion's method with `dry_run` (docs/schema/plan-1.json)
Document describe_plan(const nlohmann::ordered_json& plan);

}  // namespace odomcalib::cli
