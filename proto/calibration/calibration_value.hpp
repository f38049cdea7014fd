// A calibration in a JSON value that was parsed already, as in a call of the control interface.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib {

/// As calibration_from_json, but nesting is not limited: whoever parsed the value has done that.
Result<Calibration> calibration_from(const nlohmann::ordered_json& value, const std::string& where);

}  // namespace odomcalib
