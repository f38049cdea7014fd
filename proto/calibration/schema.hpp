// The published schema of the calibration file (docs/schema/calibration-1.json), as the list of its fields
// makes it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace odomcalib {

/// JSON Schema, draft 2020-12.
nlohmann::ordered_json calibration_schema();

}  // namespace odomcalib
