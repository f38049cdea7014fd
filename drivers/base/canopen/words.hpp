// Codes of CiA 301 in words.
#pragma once

#include <cstdint>
#include <string>

namespace odomcalib::drivers::canopen {

/// "write of a read-only object (06010002h)"
std::string abort_text(std::uint32_t code);
/// "following error (8611h)"; groups where the exact code has no name
std::string emergency_text(std::uint16_t code);
/// "operational", "pre-operational", "stopped", "boot-up"; "unknown state" otherwise
std::string nmt_state_text(std::uint8_t state);

}  // namespace odomcalib::drivers::canopen
