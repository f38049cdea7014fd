// A change all at once at one moment.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Parts into which a drive is cut to find when something happened.
inline constexpr int kChangePoints = 14;

/// 0 before the moment and 1 from then on, as when a load is taken up; on both wheels, one function for each.
/// A sensor that was moved has 1 before it and 0 from then on, for its x, y and yaw on the base: what is
/// stated of its place is where it is now.
struct ChangePoint {
  double moment = 0.0;  ///< s after the recording's first sample
  /// Functions of a smooth term that acts there.
  static std::size_t parts(vehicle::Channel channel);
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const ChangePoint&, const ChangePoint&) = default;
};

}  // namespace odomcalib::calib::terms
