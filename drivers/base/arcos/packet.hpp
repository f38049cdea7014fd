// Framing of ARCOS (Pioneer, PeopleBot, AmigoBot): FA FB, length, data, checksum; both directions.
// Source: Pioneer 3 operations manual, chapter "ARCOS".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/bytes.hpp"
#include "drivers/can/transport.hpp"

namespace odomcalib::drivers::arcos {

/// Sum of big-endian 16-bit words; a remaining byte is XORed in.
std::uint16_t checksum(Bytes data);

/// A whole packet around data of 1 to 253 bytes.
std::vector<std::uint8_t> framed(Bytes data);

/// A command with no argument, or with one of 16 bits (its sign has a place of its own).
std::vector<std::uint8_t> command(std::uint8_t number);
std::vector<std::uint8_t> command(std::uint8_t number, int argument);

struct Packet {
  std::vector<std::uint8_t> data;
  std::size_t bytes_after = 0;  ///< of the same read, to date it
};

/// Packets from bytes. After a wrong checksum the search goes on one byte later.
class PacketFinder {
 public:
  std::vector<Packet> on_bytes(std::span<const std::uint8_t> bytes);
  void reset();
  /// bytes_in = good + skipped + buffered, always.
  [[nodiscard]] Counters counters() const;

 private:
  bool step(std::vector<Packet>& out);
  bool skip(std::uint64_t* counter);

  std::vector<std::uint8_t> buffer_;  // at most one packet and one part of a read
  std::uint64_t bytes_in_ = 0, good_ = 0, skipped_ = 0, packets_ = 0, bad_checksum_ = 0, bad_length_ = 0;
};

}  // namespace odomcalib::drivers::arcos
