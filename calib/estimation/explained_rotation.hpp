// Whether the counts explain how the reference turned: for looks at recordings whose clocks or units may be
// wrong.
#pragma once

#include <vector>

#include "calib/measurement/reference_motion.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::estimation {

/// From the clock of the reference to that of the counts.
struct ClockMap {
  double from = 0.0, to = 0.0, rate = 1.0;
  [[nodiscard]] double operator()(double t) const { return to + rate * (t - from); }
};

/// Motions of the reference beside those of the wheels; without those of which there are no counts.
std::vector<wheels::WheelMotion> beside_wheels(const std::vector<measurement::ReferenceMotion>& motions,
                                               const wheels::WheelTrack& track, const ClockMap& clock = {});

/// Share of the rotation of the reference that a left + b right explains, a and b by least squares with
/// bounded residuals; 0 where there are too few motions.
double explained_rotation(const std::vector<wheels::WheelMotion>& motions);

/// Whether a mistake put right explains plainly more.
/// @param before, after shares
bool mends(double before, double after);

}  // namespace odomcalib::calib::estimation
