// All effects the software knows, by name.
#pragma once

#include <string>

#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// In the fixed order in which they are tried and listed.
const vehicle::EffectList& effect_catalogue();

/// nullptr when there is none. Effects that exist once per wheel share their name and differ by their
/// parameters.
std::shared_ptr<const vehicle::Effect> find_effect(const std::string& name,
                                                   const std::string& first_parameter = {});

/// The effect that has this part of the sensor's clock.
std::shared_ptr<const vehicle::Effect> clock_effect(vehicle::ClockPart part);

/// All effects of that name, e.g. one per wheel.
vehicle::EffectList find_effects(const std::string& name);

}  // namespace odomcalib::calib::terms
