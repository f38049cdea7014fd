// Cuts the byte stream of an RPLIDAR into answers and measurement packets. An answer descriptor says what
// follows; a stream that has lost its descriptor is recognised by its checksums.
#pragma once

#include <optional>
#include <vector>

#include "drivers/lidar/common/frame_buffer.hpp"
#include "drivers/lidar/rplidar/packet.hpp"

namespace odomcalib::drivers::rplidar {

struct Item {
  enum class Kind { descriptor, answer, packet };
  Kind kind = Kind::packet;
  std::uint8_t type = 0;  ///< of the descriptor; PacketType for packets
  std::vector<std::uint8_t> bytes;
  std::size_t bytes_after = 0;  ///< of the same read, behind this item
};

class Stream {
 public:
  /// @param guess whether packets are accepted without a descriptor, as in a recording that begins in the
  /// middle
  /// @param guessed type taken for such packets of 84 bytes, of which two types exist that look alike; none:
  /// the distances tell
  Stream(bool guess, std::optional<PacketType> guessed) : guess_(guess), guessed_(guessed) {}

  std::vector<Item> on_bytes(Bytes bytes);
  /// The device was told to stop: whatever comes before the next descriptor is left over.
  void expect_descriptor();
  void reset();
  /// The recording ends: what could not be told yet is not decoded, and counted.
  void finish();
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }
  [[nodiscard]] FrameBuffer& frames() { return frames_; }

 private:
  Verdict look(Bytes rest, std::vector<Item>& out);
  Verdict take_descriptor(Bytes rest, std::vector<Item>& out);
  Verdict take_answer(Bytes rest, std::vector<Item>& out);
  Verdict take_packet(Bytes rest, std::vector<Item>& out);
  Verdict guess_format(Bytes rest);
  Verdict lost_packet(Bytes rest);

  bool guess_;
  std::optional<PacketType> guessed_;
  bool layout_open_ = false;              // sound capsules wait for what tells their layout
  const PacketFormat* format_ = nullptr;  // of the measurement stream
  bool in_step_ = false;                  // standard packets only: the last one was right
  std::uint8_t answer_type_ = 0;
  std::optional<std::size_t> answer_bytes_;
  FrameBuffer frames_{"bad_checksum",  "bad_check_bits", "bad_descriptor",  "unknown_packet_type", "bad_span",
                      "motor_stopped", "lost_packets",   "angle_backwards", "ambiguous_capsule"};
};

}  // namespace odomcalib::drivers::rplidar
