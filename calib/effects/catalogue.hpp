// All effects the software knows, by name.
#pragma once

#include <string>

#include "calib/model/drive_model.hpp"

namespace odomcalib::calib {

/// In the fixed order in which they are tried and listed.
const EffectList& effect_catalogue();

/// nullptr when there is no effect of that name.
std::shared_ptr<const Effect> find_effect(const std::string& name);

}  // namespace odomcalib::calib
