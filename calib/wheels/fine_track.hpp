// Ticks that come seldom, as wheels turn between them.
#pragma once

#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::wheels {

/// The track with samples at most 30 ms apart. Where a wheel speeds up, constant speed between samples 0.1 s
/// apart runs ahead by a dt^2 / 12 on the average, and as that grows and fades with the acceleration it
/// lengthens wheels by some 0.1 %: between the samples of a segment the angles follow a cubic (modified
/// Akima: Akima 1970, J. ACM 17(4), eq. 3, with weights that keep a standing wheel still). Gaps of over half
/// a second stay as they are.
WheelTrack finely_sampled(const WheelTrack& track);

}  // namespace odomcalib::calib::wheels
