// Answers of the daemon, as far as they are of the version that is known here.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::cli {

/// All of an answer. Error format: it is no object, or lacks the member.
/// @param answer JSON text
/// @param member empty: none is asked for
Result<nlohmann::ordered_json> answer_with(const std::string& answer, const std::string& method,
                                           const std::string& member);

/// Whether a row of the checks stands in the way. An outcome that is not known here does.
bool stands_in_the_way(const nlohmann::ordered_json& check);

}  // namespace odomcalib::cli
