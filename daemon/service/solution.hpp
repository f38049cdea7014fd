// What the loop sends on of a calibration. The solver's thread makes it: on a small computer it takes longer
// than the drive waits for a sign of life.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/service/calibrator.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib {

struct Solution {
  std::string calibration;       ///< JSON text, as in a file
  std::string reply;             ///< frame for the caller
  std::string line;              ///< for the journal
  std::vector<PathTrace> paths;  ///< of the drive, for viewers
};

/// @param recording the one just driven
Solution solution_of(const Calibrator& calibrator, const Calibration& calibration,
                     const std::filesystem::path& recording);

}  // namespace odomcalib
