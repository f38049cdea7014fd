// Change points in words for a user.
#pragma once

#include <string>

#include "calib/math/se2.hpp"
#include "calib/selection/selection_json.hpp"

namespace odomcalib::calib::selection {

/// What changed at which moment, by how much, and which state the values stand for.
/// @param event a smooth term that happens at once
/// @param mount of the sensor on the base, since then
std::string event_to_text(const FittedSmoothTerm& event, const math::Pose& mount);

}  // namespace odomcalib::calib::selection
