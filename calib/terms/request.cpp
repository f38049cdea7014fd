#include "calib/terms/request.hpp"

#include "calib/terms/catalogue.hpp"
#include "calib/terms/effect_names.hpp"

namespace odomcalib::calib::terms {

Result<Request> request_for(const std::vector<std::string>& names) {
  if (auto wrong = wrong_effects(names)) return *wrong;
  Request request;
  request.is_automatic = names == std::vector<std::string>{"auto"};
  if (request.is_automatic || names == std::vector<std::string>{"none"}) return request;
  for (const std::string& name : names) {
    if (const auto of_lidar = find_lidar_effect(name)) {
      request.lidar_effects.push_back(of_lidar);
      continue;
    }
    const vehicle::EffectList found = find_effects(name);
    request.effects.insert(request.effects.end(), found.begin(), found.end());
  }
  return request;
}

}  // namespace odomcalib::calib::terms
