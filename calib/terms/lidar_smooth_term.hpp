// Dependences of a lidar's error that no named effect stands for.
#pragma once

#include <array>
#include <vector>

#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {

/// How an error of the range may depend on the incidence: the spot on a slanted surface is drawn out, more
/// the farther; even and odd parts of both.
std::array<double, 4> slants(const Sighting& sighting);

/// Range error that depends on the incidence; its coefficients are those of slants().
LidarEffectPtr make_incidence_error();

/// Range error that is another in each part of the view.
/// @param bearings rad, of all sightings; nothing is said where there are few
/// @return null when they are too few anywhere
LidarEffectPtr make_sector_error(const std::vector<double>& bearings);

/// One for each covariate and direction of the displacement: "bearing", "range", "incidence".
std::vector<LidarEffectPtr> lidar_smooths();

}  // namespace odomcalib::calib::terms
