// A map made of a recording, as it is printed.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "calib/slam/recording_map.hpp"
#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

nlohmann::ordered_json to_json(const calib::slam::RecordingMap& map);
Document describe(const calib::slam::RecordingMap& map);

}  // namespace odomcalib::cli
