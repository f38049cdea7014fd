// Geometry of a SCIP sensor as the sensor reports it (command PP).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace odomcalib::drivers::scip {

struct Parameters {
  unsigned steps_per_turn = 0;      ///< ARES
  unsigned first = 0, last = 0;     ///< AMIN, AMAX
  unsigned front = 0;               ///< AFRT: straight ahead
  unsigned min_mm = 0, max_mm = 0;  ///< DMIN, DMAX
  unsigned turns_per_minute = 0;    ///< SCAN
};

/// "KEY:value" lines by key.
std::map<std::string, std::string> fields_of(const std::vector<std::string>& lines);

/// Absent when a field is missing, or the values contradict each other.
std::optional<Parameters> read_parameters(const std::vector<std::string>& lines);

/// Parameters of sensors whose recordings may lack them: "utm30lx" (also UST-10LX, UST-20LX), "urg04lx".
std::optional<Parameters> known_parameters(const std::string& model);

}  // namespace odomcalib::drivers::scip
