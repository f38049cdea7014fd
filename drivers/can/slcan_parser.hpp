// Lawicel ASCII lines from bytes, without a port: lines ended by CR (some adapters: CR LF), BEL for a refused
// command, frames at any time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/settings.hpp"
#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

/// One thing the adapter said.
struct SlcanItem {
  enum class Kind {
    done,      ///< bare CR, or z / Z: a command was carried out
    refused,   ///< BEL
    frame,     ///< a frame from the bus
    text,      ///< answer to V, v, N, F
    bus_state  ///< state or error line of newer firmware; text holds it
  } kind = Kind::done;
  CanFrame frame;
  std::optional<std::uint16_t> stamp_ms;  ///< frame: adapter's clock 0..59999, when switched on
  std::string text;
  std::size_t bytes = 0;        ///< of this item, with its CR; with the next one they date it
  std::size_t bytes_after = 0;  ///< bytes of the same read that came after this item
};

class SlcanParser {
 public:
  /// Everything that became complete with these bytes. Lines that do not parse are dropped and counted.
  std::vector<SlcanItem> on_bytes(std::span<const std::uint8_t> bytes);
  void reset();
  /// bytes_in = good + skipped + buffered, always; skipped splits into the kinds of rejection by lines.
  [[nodiscard]] Counters counters() const;
  [[nodiscard]] std::uint64_t bytes_in() const { return bytes_in_; }

 private:
  void finish_line(std::vector<SlcanItem>& out, std::size_t bytes_after);
  void reject(std::uint64_t& counter);
  void overflow();

  static constexpr std::size_t kLongestLine = can::kLongestLine;
  std::array<char, kLongestLine> line_{};
  std::size_t used_ = 0;
  bool overlong_ = false;  // the rest of an overlong line is skipped up to its CR
  std::uint64_t bytes_in_ = 0, good_ = 0, skipped_ = 0;
  std::uint64_t frames_ = 0, refused_ = 0, bad_line_ = 0, long_line_ = 0, fd_frame_ = 0;
};

/// The line that sends a frame, CR included; empty for error frames, which cannot be sent.
std::string slcan_line(const CanFrame& frame);

}  // namespace odomcalib::drivers
