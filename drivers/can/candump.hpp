// Lines of a candump log: "(1436509052.249713) can0 044#2A366C2BBA".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/can/transport.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

/// Classic frames only; nullopt for anything else (CAN FD, cut off, damaged). CanFrame::t is the time in the
/// log.
/// @param line without its end; a trailing CR, " R" or " T" and dots between data bytes are allowed
std::optional<CanFrame> parse_candump_line(std::string_view line);

/// "(1.000000) can0 181#0A00": the form that candump -l writes and canplayer reads, without the line's end.
std::string candump_line(const CanFrame& frame, std::string_view interface);

/// The frames of a whole log, one at a time.
class CandumpReader {
 public:
  explicit CandumpReader(std::string_view text) : all_(text), rest_(text) { bytes_in_ = text.size(); }
  /// nullopt at the end. What is not a frame is counted and passed over.
  std::optional<CanFrame> next();
  /// bytes_in = good + skipped + buffered (a line cut off at the end); fd_frame, bad_line; time_backwards
  /// counts frames that are older than the one before, as when several interfaces are mixed.
  [[nodiscard]] Counters counters() const;
  /// Problem of a whole log without a frame: error format when it is candump's output on the screen, which
  /// has no dates that can be trusted, or another program's log. Nothing of a log that is merely damaged.
  /// @param where name of the file
  [[nodiscard]] std::optional<Error> problem(const std::string& where) const;

 private:
  std::string_view all_, rest_;
  double last_t_ = 0.0;
  std::uint64_t bytes_in_ = 0, good_ = 0, skipped_ = 0, buffered_ = 0;
  std::uint64_t bad_line_ = 0, fd_frame_ = 0, time_backwards_ = 0, screen_line_ = 0;
};

}  // namespace odomcalib::drivers
