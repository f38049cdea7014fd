// Telegrams of SICK's CoLa protocol in both dialects: text between STX and ETX (A), or binary with a length
// and an XOR checksum (B). Source: SICK, "Telegram Listing, Ranging sensors LMS1xx, LMS5xx, TiM2xx, TiM5xx,
// TiM7xx, ..." (8014631).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/cola/scan_data.hpp"
#include "drivers/lidar/common/frame_buffer.hpp"

namespace odomcalib::drivers::cola {

struct Telegram {
  Dialect dialect = Dialect::binary;
  std::string kind;                     ///< "sRA", "sSN", "sFA", ...
  std::string name;                     ///< "LMDscandata"; empty for sFA
  std::vector<std::uint8_t> arguments;  ///< behind the blank after the name
  std::optional<ScanData> scan;         ///< of LMDscandata
};

/// Cuts bytes into telegrams. Rejections: bad_checksum, bad_length, cut_telegram (a new one begins inside),
/// bad_telegram (no command), bad_scan (scan data that contradict themselves).
class TelegramFinder {
 public:
  std::vector<Telegram> on_bytes(Bytes bytes);
  void reset() { frames_.reset(); }
  [[nodiscard]] FrameBuffer& frames() { return frames_; }
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }

 private:
  FrameBuffer frames_{"bad_checksum", "bad_length",     "cut_telegram", "bad_telegram",
                      "bad_scan",     "repeated_scans", "lost_scans",   "other_layers"};
};

/// @param argument one digit: a character in dialect A, a byte in dialect B
std::vector<std::uint8_t> encode(Dialect dialect, const std::string& command,
                                 std::optional<std::uint8_t> argument = std::nullopt);

}  // namespace odomcalib::drivers::cola
