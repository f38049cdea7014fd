// Rotation that a gear train with play loses when its motor turns round.
#pragma once

#include <array>

namespace odomcalib::calib::vehicle {

/// rad; the play of a gear train is not known either (Renard numbers, ISO 3, R10).
inline constexpr std::array<double, 20> kPlays = {0.004, 0.005, 0.0063, 0.008, 0.01, 0.0125, 0.016,
                                                  0.02,  0.025, 0.0315, 0.04,  0.05, 0.063,  0.08,
                                                  0.1,   0.125, 0.16,   0.2,   0.25, 0.315};
using LostToPlay = std::array<double, kPlays.size()>;

/// A motor that turns to and fro within the play of its gears, for each of kPlays.
class GearPlay {
 public:
  /// @param delta rad, rotation of the wheel in an interval
  /// @param dither rad, within which a wheel that stands may show either of two counts
  /// @return rotation of this interval that does not reach the wheel, rad
  LostToPlay advance(double delta, double dither);

 private:
  bool has_moved_ = false;
  std::array<double, kPlays.size()> gap_{};  ///< rad, from the flank that drives backwards
};

}  // namespace odomcalib::calib::vehicle
