// Counts of two wheels that come in separate messages, brought to common instants.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace odomcalib::drivers {

enum class Side : std::uint8_t { left = 0, right = 1 };

/// A pair is dated by its left count. The right count is the one of the same instant, or interpolated between
/// the two right counts around it, rounded to a whole count: late by at most one period, never extrapolated.
class TickPairing {
 public:
  struct Pair {
    double t = 0.0;
    std::int64_t left = 0, right = 0;
  };

  /// @param t dates of one side never go back
  /// @return the pair that became complete
  std::optional<Pair> add(Side side, double t, std::int64_t count);
  /// Counts were reset: nothing is interpolated across.
  void forget();
  /// Left counts for which no right ones came in time.
  [[nodiscard]] std::uint64_t unpaired() const { return unpaired_; }

 private:
  struct Count {
    double t = 0.0;
    std::int64_t value = 0;
  };
  std::optional<Pair> pair_between(const Count& before, const Count& after);

  std::optional<Count> waiting_left_, last_right_;
  std::uint64_t unpaired_ = 0;
};

}  // namespace odomcalib::drivers
