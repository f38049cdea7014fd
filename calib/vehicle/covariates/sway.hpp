// A mast that follows what bends it late.
#pragma once

#include <array>

namespace odomcalib::calib::vehicle {

/// s; the time constants by which a mast may follow the base's acceleration late, the usual one second (see
/// kUsualMemory).
inline constexpr std::array<double, 4> kSwayLags = {0.05, 0.0, 0.1, 0.2};
using Sways = std::array<double, kSwayLags.size()>;

/// A mast with friction follows with a time constant.
class SwayLag {
 public:
  /// @param before rad/s^2, at the begin of an interval, as late as each lag when this returns
  /// @param after the same at its end
  /// @param dt s
  void advance(Sways& before, Sways& after, double dt);

 private:
  Sways bend_{};
};

}  // namespace odomcalib::calib::vehicle
