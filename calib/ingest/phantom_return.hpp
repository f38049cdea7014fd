// Readings that are no distances: a lidar or its driver that writes a fixed number where nothing came back.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/ingest/recordings.hpp"

namespace odomcalib::calib::ingest {

/// The number, m, that far more readings equal to the last digit than any of its neighbours, all the way
/// through the recording: what stands for no return, or a part of the robot. nullopt where none does.
std::optional<double> phantom_return(const Recording& recording);

struct Cleaned {
  Recordings recordings;
  std::vector<std::string> remarks = {};  ///< what a user should know of it
};

/// Recordings whose readings of such a number are no readings, and count as discarded beams; without any the
/// recordings given.
Cleaned without_phantom_returns(std::span<const Recording> given);

}  // namespace odomcalib::calib::ingest
