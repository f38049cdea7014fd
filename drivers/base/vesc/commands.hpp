// Numbers of the VESC's CAN commands (identifier = command << 8 | controller) and of its packets.
#pragma once

#include <cstdint>

namespace odomcalib::drivers::vesc {

inline constexpr std::uint32_t kSetCurrent = 1, kSetRpm = 3, kFillBuffer = 5, kFillBufferLong = 6,
                               kProcessBuffer = 7, kProcessShort = 8, kStatus1 = 9, kStatus2 = 14,
                               kStatus3 = 15, kStatus4 = 16, kPing = 17, kPong = 18, kStatus5 = 27;
inline constexpr std::uint8_t kGetTemporaryConfiguration = 91;  // COMM_GET_MCCONF_TEMP

}  // namespace odomcalib::drivers::vesc
