// How far a long computation has come.
#pragma once

#include <functional>
#include <string>

namespace odomcalib::calib::measurement {

/// Called with a phase name and its completed share in [0, 1]; never called with a smaller share within a
/// phase.
using Progress = std::function<void(const std::string& phase, double fraction)>;

}  // namespace odomcalib::calib::measurement
