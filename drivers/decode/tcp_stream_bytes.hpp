// One direction of a TCP connection from its segments: in order, without repetitions, with every gap told.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers {

class TcpStreamBytes {
 public:
  /// Bytes that follow each other.
  struct Run {
    std::vector<std::uint8_t> bytes;
    bool after_gap = false;  ///< what came before them was not captured
  };

  /// A segment begins the connection: nothing before it belongs to it.
  void on_start(std::uint32_t sequence);
  /// @param sequence number of the first byte of data
  void on_segment(std::uint32_t sequence, Bytes data);
  /// The other side has everything before `sequence`: what is still missing was not captured.
  void on_acknowledged(std::uint32_t sequence);
  /// The capture ends: what waits is given out behind its gaps.
  void finish();

  std::vector<Run> take() { return std::exchange(runs_, {}); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t repeated() const { return repeated_; }  ///< bytes
  [[nodiscard]] std::uint64_t lost() const { return lost_; }          ///< bytes that were not captured
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }

 private:
  /// Where a sequence number lies on the scale of next_.
  [[nodiscard]] std::int64_t position(std::uint32_t sequence) const;
  void append(Bytes data);
  void give_out_waiting();
  void skip_to(std::int64_t at);

  bool started_ = false;
  std::int64_t next_ = 0;  // position of the next byte; its low 32 bits are the sequence number
  std::map<std::int64_t, std::vector<std::uint8_t>> waiting_;  // by position, beyond next_
  std::size_t waiting_bytes_ = 0;
  bool after_gap_ = false;
  std::vector<Run> runs_;
  std::uint64_t bytes_ = 0, repeated_ = 0, lost_ = 0, gaps_ = 0;
};

}  // namespace odomcalib::drivers
