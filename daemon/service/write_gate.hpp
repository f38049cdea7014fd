// What must be true before values are written to the controller.
#pragma once

#include <optional>

#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// The axes have torque, or one of them: nothing drives them while a write-back may begin, so it goes.
bool comes_to_rest(const Bench& bench);
Error axes_not_off(const Bench& bench);

/// Why nothing may be written now. Axes that come to rest are waited for, by whoever writes.
std::optional<Error> write_forbidden(const Bench& bench);

/// Why these values are not this robot's.
std::optional<Error> implausible(const ParameterMap& values, const ParameterMap& present);

/// Lengths in force, by the names of the parameters.
ParameterMap present_lengths(const RobotDescription& robot);

}  // namespace odomcalib
