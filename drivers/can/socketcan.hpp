// The kernel's CAN sockets.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

/// @param size as returned by the read; nullopt unless it is a whole classic frame with a length of at most 8
std::optional<CanFrame> from_kernel(const can_frame& raw, std::size_t size);
can_frame to_kernel(const CanFrame& frame);

/// @param interface e.g. can0; it must be up, with its bit rate set
/// Errors: device (no CAN in this kernel, no such interface, interface down), with the command that helps.
Result<std::unique_ptr<CanTransport>> open_socketcan(const std::string& interface);

}  // namespace odomcalib::drivers
