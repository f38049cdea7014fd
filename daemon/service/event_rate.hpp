// Events of one kind come so often at most: a cable that flaps must not fill the journal.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace odomcalib {

class EventRate {
 public:
  /// Some at once, then a few a second (settings: kEventsAtOnce, kEventPause_s).
  /// @param now s
  /// @return how many of this kind were left out since one went through; nullopt: this one is left out, too
  [[nodiscard]] std::optional<std::uint64_t> admit(const std::string& code, double now);

 private:
  struct Kind {
    double allowance = 0.0, refilled = 0.0;  // events; s
    std::uint64_t left_out = 0;
  };
  std::map<std::string, Kind> kinds_;
};

}  // namespace odomcalib
