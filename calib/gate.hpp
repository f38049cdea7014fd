// The quality gate: may this calibration be written to a robot?
#pragma once

#include <string>
#include <vector>

#include "proto/calibration.hpp"

namespace odomcalib::calib {

struct GateResult {
  Verdict verdict = Verdict::refused;
  std::vector<std::string> reasons;
};

/// Refuses implausible or badly determined values and says which motion is missing; warns of what a user
/// should know.
GateResult judge(const Calibration& calibration, bool converged);

}  // namespace odomcalib::calib
