// What a user requests by the names of effects.
#pragma once

#include <string>
#include <vector>

#include "calib/terms/lidar_effect.hpp"
#include "calib/vehicle/effect.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::terms {

struct Request {
  bool is_automatic = false;  ///< what nobody names is to be looked for
  vehicle::EffectList effects;
  std::vector<LidarEffectPtr> lidar_effects;
};

/// @param names see wrong_effects(), whose errors are returned
Result<Request> request_for(const std::vector<std::string>& names);

}  // namespace odomcalib::calib::terms
