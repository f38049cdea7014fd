// Reading what the offline verbs name on their command line.
#pragma once

#include <string>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::cli {

/// @param robot_file TOML with nominal values that replace those of the recordings; empty: none
Result<std::vector<Recording>> read_recordings(const std::vector<std::string>& paths,
                                               const std::string& robot_file);

}  // namespace odomcalib::cli
