// Winding that tyres, belts and gears release at rest after a motion has wound them up.
#pragma once

#include <array>
#include <cstddef>

#include "calib/math/se2.hpp"
#include "calib/vehicle/covariates/standstill.hpp"

namespace odomcalib::calib::vehicle {

/// Winding released after a stop, as shares of the most that a motion can wind up: a straight motion winds
/// up by its way, one on the spot by its turn, -1 to 1 in all.
struct ReleasedWinding {
  double way = 0.0;
  double turn = 0.0;
};
/// The next few centimetres wind up anew whatever they are, as they do with the side walls of tyres; or a
/// turn stays wound up until another.
inline constexpr std::size_t kWindings = 2;

class Winding {
 public:
  struct Rims {
    double left = 0.0, right = 0.0;  ///< m, of either in the interval
    double speed = 0.0;              ///< m/s, of the faster one
  };
  /// @param step of the base; @param dt s
  /// @return what unwinds in the interval, by each way of winding up
  std::array<ReleasedWinding, kWindings> advance(const Standstill& standstill, const Rims& rims,
                                                 const math::Pose& step, double dt);
  /// Rim speed since the robot last stood, m/s.
  [[nodiscard]] double fastest() const { return fastest_; }

 private:
  void wind_up(const Rims& rims, const math::Pose& step);
  std::array<ReleasedWinding, kWindings> unwind(double duration);

  std::array<ReleasedWinding, kWindings> wound_{};
  double fastest_ = 0.0;
};

}  // namespace odomcalib::calib::vehicle
