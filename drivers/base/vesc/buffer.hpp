// Packets longer than a CAN frame, as a VESC cuts them: pieces with an offset, then one frame with length and
// checksum that closes them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/bytes.hpp"
#include "drivers/can/transport.hpp"

namespace odomcalib::drivers::vesc {

// Numbers of the VESC's CAN commands (identifier = command << 8 | controller) and of its packets.
inline constexpr std::uint32_t kSetCurrent = 1, kSetRpm = 3, kFillBuffer = 5, kFillBufferLong = 6,
                               kProcessBuffer = 7, kProcessShort = 8, kStatus1 = 9, kStatus2 = 14,
                               kStatus3 = 15, kStatus4 = 16, kPing = 17, kPong = 18, kStatus5 = 27;
inline constexpr std::uint8_t kGetTemporaryConfiguration = 91;  // COMM_GET_MCCONF_TEMP

inline constexpr std::size_t kMostBytes = 1024;

/// CRC-16, polynomial 1021h, initial value 0.
std::uint16_t checksum(Bytes bytes);

class ReceiveBuffer {
 public:
  /// FILL_RX_BUFFER: u8 offset, up to 7 bytes; FILL_RX_BUFFER_LONG: u16 offset, up to 6.
  void on_piece(Bytes data, bool long_offset);
  /// PROCESS_RX_BUFFER: sender, flag, u16 length, u16 checksum. The packet when every byte of it came.
  std::optional<std::vector<std::uint8_t>> on_end(Bytes data);
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  std::array<std::uint8_t, kMostBytes> bytes_{};
  std::array<bool, kMostBytes> filled_{};
  std::uint64_t rejected_ = 0;
};

/// Frames that carry a packet to a controller.
/// @param sender our own id, to which the answer goes
std::vector<CanFrame> pieces_of(Bytes packet, std::uint8_t to, std::uint8_t sender);

}  // namespace odomcalib::drivers::vesc
