// LCM event logs (protocol text, section 6): events one after the other, no header, no index, no end mark.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace odomcalib {

struct LogEvent {
  std::int64_t number = 0;
  std::int64_t time_us = 0;  ///< receipt by the logger; may go backwards
  std::string_view channel;
  std::string_view data;
};

/// Goes through the bytes of a log and finds its way behind garbage. Views point into the bytes given.
class EventLogReader {
 public:
  /// Every byte is accounted for: at the end, bytes == good + skipped + cut_off.
  struct Counters {
    std::size_t good = 0;     ///< bytes of events returned
    std::size_t skipped = 0;  ///< bytes between events, and of damaged events
    std::size_t cut_off = 0;  ///< bytes of an unfinished last event
    std::size_t damaged = 0;  ///< events whose lengths are impossible or run into the next event
    std::size_t garbage = 0;  ///< places where bytes had to be skipped
  };

  explicit EventLogReader(std::string_view bytes) : bytes_(bytes) {}
  std::optional<LogEvent> next();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] std::optional<LogEvent> event_at(std::size_t at, std::size_t& size) const;
  [[nodiscard]] bool is_unfinished(std::size_t at) const;
  void skip_to(std::size_t at);

  std::string_view bytes_;
  std::size_t at_ = 0;
  Counters counters_;
};

/// True when the bytes begin with an event, or hold one near their begin.
bool looks_like_event_log(std::string_view bytes);

}  // namespace odomcalib
