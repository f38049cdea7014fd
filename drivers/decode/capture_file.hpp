// Files that hold what a device sent.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace odomcalib::drivers {

/// The device's bytes of a file in one of these notations, told apart by content:
/// - lines "TIME < HEX" and "TIME > HEX" of a session (TIME in s or "-"): those from the device (<);
/// - nothing but hexadecimal digits, as printed in data sheets;
/// - anything else: raw bytes.
std::vector<std::uint8_t> device_bytes(std::string_view file);

}  // namespace odomcalib::drivers
