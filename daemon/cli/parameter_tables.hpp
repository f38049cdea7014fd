// Parameters of the controller and what was written to it, as tables in mm.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

/// @param parameters as GetParameters answers
Document describe_parameters(const nlohmann::ordered_json& parameters);
/// @param entries as History answers, newest first
Document describe_history(const nlohmann::ordered_json& entries);
/// @param result of Apply or Rollback: outcome, steps, parameters
Document describe_write_back(const nlohmann::ordered_json& result);

/// Checks of what is possible: name, outcome, what was found, remedy.
Document describe_checks(const nlohmann::ordered_json& checks);

}  // namespace odomcalib::cli
