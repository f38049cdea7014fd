// Meanings of the parameters of the effects, in words for who reads a report: those that the rows state.
#pragma once

#include <string_view>

#include "calib/vehicle/parameter_meaning.hpp"

namespace odomcalib::calib::terms {

using vehicle::ParameterMeaning;

/// The meaning that the row of the effect states; of wheels or of the lidar.
/// @return nullptr where there is none, as for a parameter of a file from another version
const ParameterMeaning* meaning_of(std::string_view effect, std::string_view parameter);

}  // namespace odomcalib::calib::terms
