// Floors that repeat themselves: which waves a drive could show.
#pragma once

#include <span>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// Waves of 0.2 to 1.25 m in all directions of the plane, as far apart as the place that was driven on can
/// tell them (its Fourier transform's resolution). None where wheels are scored on more than one recording,
/// whose places have no common origin.
std::vector<SmoothTerm> periodic_smooths(std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
