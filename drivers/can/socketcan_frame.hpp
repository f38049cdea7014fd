// Between the kernel's struct can_frame and ours, without a socket.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <optional>

#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

/// @param size as returned by the read; nullopt unless it is a whole classic frame with a length of at most 8
std::optional<CanFrame> from_kernel(const can_frame& raw, std::size_t size);
can_frame to_kernel(const CanFrame& frame);

}  // namespace odomcalib::drivers
