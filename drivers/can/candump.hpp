// Lines of a candump log: "(1436509052.249713) can0 044#2A366C2BBA".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

/// Classic frames only; nullopt for anything else (CAN FD, cut off, damaged). CanFrame::t is the time in the
/// log.
/// @param line without its end; a trailing CR, " R" or " T" and dots between data bytes are allowed
std::optional<CanFrame> parse_candump_line(std::string_view line);

}  // namespace odomcalib::drivers
