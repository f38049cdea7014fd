// Answer of the service to `status`, for people.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// @param status as docs/schema/status-1.json has it
Document describe_status(const nlohmann::ordered_json& status);

}  // namespace odomcalib::cli
