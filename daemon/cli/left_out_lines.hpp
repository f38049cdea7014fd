// Data left out of recordings, and data put right in them, as lines for people.
#pragma once

#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::cli {

/// Items left out that are more than a trace and not among the reasons of the verdict, most first: at most
/// settings::kLeftOutLines.
std::vector<std::string> left_out_lines(const Calibration& calibration);

/// All of it, and what was put right.
std::vector<std::string> evidence_lines(const Calibration& calibration);
/// All of it; what was put right is told when a recording is read.
std::vector<std::string> evidence_lines(const Recording& recording);

/// Whatever dead reckoning goes on without, one warning each.
void warn_of_lost_motion(const Recording& recording);

}  // namespace odomcalib::cli
