// What must be true before values are written to the controller.
#pragma once

#include <optional>

#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// Why nothing may be written now.
std::optional<Error> write_forbidden(const Bench& bench);

/// Why these values are not this robot's.
std::optional<Error> implausible(const ParameterMap& values, const ParameterMap& present);

/// Lengths in force, by the names of the parameters.
ParameterMap present_lengths(const RobotDescription& robot);

}  // namespace odomcalib
