// Stops the wheels without the service: what systemd runs after a daemon that ended in any way
// (ExecStopPost).
#pragma once

#include "daemon/config/config.hpp"
#include "daemon/service/clock.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Opens the controller's line and sends quick stops for half a second, so that one lost frame does not
/// matter. A CANopen drive is identified first, as always before anything is sent to it. Nothing is enabled.
/// @param config of the daemon that ended
/// Errors: those of the profile and the line; device when the line is away (then nothing can be sent).
Result<void> quick_stop(const Config& config, const Clock& clock);

}  // namespace odomcalib
