// Where casters point.
#pragma once

#include <array>
#include <cstddef>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::vehicle {

/// m; trails of casters are not known either ...
inline constexpr std::array<double, 6> kCasterTrails = {0.02, 0.028, 0.04, 0.057, 0.08, 0.113};
/// ... nor by how much a caster that has settled still points past its way, rad: to which side it falls after
/// a straight motion is reversed hangs on this alone.
inline constexpr std::array<double, 5> kCasterLeans = {0.0, -0.002, 0.002, -0.01, 0.01};
inline constexpr std::size_t kCasters = kCasterTrails.size() * kCasterLeans.size();  ///< by trail, then lean
using CasterSines = std::array<double, kCasters>;

/// A caster behind the axle, for each trail and lean.
class CasterSwing {
 public:
  /// @param step of the base; @param track_width m
  /// @return sine of the angle by which each still points past the way its pivot moves
  CasterSines advance(const math::Pose& step, double track_width);

 private:
  std::array<double, kCasters> direction_{};  ///< rad, in which each would roll, base axes
};

}  // namespace odomcalib::calib::vehicle
