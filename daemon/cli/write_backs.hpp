// Write-backs as the service keeps them.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace odomcalib::cli {

/// Adds "user_name" to entries of the history whose user has a name on this machine: the daemon knows numbers
/// only, because a directory service may take its time.
void name_users(nlohmann::ordered_json& entries);

}  // namespace odomcalib::cli
