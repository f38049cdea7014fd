// The kernel's CAN sockets.
#pragma once

#include <memory>
#include <string>

#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

/// @param interface e.g. can0; it must be up, with its bit rate set
/// Errors: device (no CAN in this kernel, no such interface, interface down), with the command that helps.
Result<std::unique_ptr<CanTransport>> open_socketcan(const std::string& interface);

}  // namespace odomcalib::drivers
