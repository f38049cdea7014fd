// Causes of the tyres' sideways slip, as late as the tyres follow them.
#pragma once

#include <array>

namespace odomcalib::calib::vehicle {

/// m; the ways over which tyres take up a slip angle are not known either (Pacejka, Tire and Vehicle
/// Dynamics, chapter 7).
inline constexpr std::array<double, 3> kRelaxations = {0.03, 0.07, 0.15};
using Relaxed = std::array<double, kRelaxations.size()>;

class TyreRelaxation {
 public:
  /// @param way m, of the base in its direction; @param turn_rate rad/s; @param lateral_acceleration m/s^2
  void advance(double way, double turn_rate, double lateral_acceleration);
  [[nodiscard]] const Relaxed& turn_rate() const { return turn_rate_; }                        ///< rad/s
  [[nodiscard]] const Relaxed& lateral_acceleration() const { return lateral_acceleration_; }  ///< m/s^2

 private:
  Relaxed turn_rate_{}, lateral_acceleration_{};
};

}  // namespace odomcalib::calib::vehicle
