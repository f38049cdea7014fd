// Replies of the SCIP 2.0 protocol: lines of text, each with a sum, up to an empty line.
// Source: Hokuyo, "Communication Protocol Specification for SCIP2.0 Standard".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/common/frame_buffer.hpp"

namespace odomcalib::drivers::scip {

/// Measurement that an M or G command returns.
struct Measurement {
  unsigned first_step = 0, last_step = 0, cluster = 1;
  std::uint32_t stamp_ms = 0;  ///< 24 bits, of the start of the revolution at the rear
  std::vector<std::uint32_t> ranges_mm;
  std::vector<std::uint32_t> intensities;  ///< empty when not asked for
};

struct Reply {
  std::string echo;
  std::string status;              ///< two characters
  std::vector<std::string> lines;  ///< without their sums
  std::optional<Measurement> measurement;
};

inline constexpr std::uint32_t kClockModulus_ms = 1U << 24U;

/// Character that ends a line: the sum of those before it, folded into 30h..6Fh.
char sum_of(const std::string& text);

/// Cuts bytes into replies. Rejections: bad_sum, bad_reply (no status, or too long), bad_data (a measurement
/// whose characters or whose number of values are wrong).
class ReplyFinder {
 public:
  std::vector<Reply> on_bytes(Bytes bytes);
  void reset() { frames_.reset(); }
  [[nodiscard]] FrameBuffer& frames() { return frames_; }
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }

 private:
  FrameBuffer frames_{"bad_sum", "bad_reply", "bad_data", "no_parameters", "repeated_scans", "lost_scans"};
};

}  // namespace odomcalib::drivers::scip
