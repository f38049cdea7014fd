// A user's request by the names of effects.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/terms/lidar_effect.hpp"
#include "calib/vehicle/effect.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::terms {

/// In a fixed order, each once: effects of wheels, clocks and floor, then of the lidar.
std::vector<std::string> effect_names();

/// Why SolveOptions::effects makes no sense, with the names that there are; nullopt when it does: "auto" or
/// "none" alone, or known names, each once.
std::optional<Error> wrong_effects(const std::vector<std::string>& wanted);

struct Request {
  bool is_automatic = false;  ///< what nobody names is to be looked for
  vehicle::EffectList effects;
  std::vector<LidarEffectPtr> lidar_effects;
};

/// @param names see wrong_effects(), whose errors are returned
Result<Request> request_for(const std::vector<std::string>& names);

}  // namespace odomcalib::calib::terms
