// JSON as text, whatever bytes are in it: file names and texts of devices need not be UTF-8, and the strict
// way of nlohmann-json throws on those, which would end the daemon.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace odomcalib {

inline std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace odomcalib
