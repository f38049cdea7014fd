#include "calib/terms/request.hpp"

#include <algorithm>

#include "calib/terms/catalogue.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "proto/near_miss.hpp"

namespace odomcalib::calib::terms {
namespace {

bool is_among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Error wrong(const std::string& what) {
  std::string remedy = "auto, none, or of these, separated by commas:";
  for (const std::string& name : effect_names()) remedy += " " + name;
  return {ErrorCode::usage, what, "--effects", remedy};
}

std::string meant(const std::string& name, const std::vector<std::string>& known) {
  const auto word = near_miss(name, {known.begin(), known.end()});
  return word ? ", did you mean \"" + *word + "\"?" : "";
}

}  // namespace

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

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (const auto& effect : effect_catalogue())
    if (!is_among(names, effect->name())) names.push_back(effect->name());
  for (const auto& effect : lidar_catalogue(false))
    if (!is_among(names, effect->name())) names.push_back(effect->name());
  return names;
}

std::optional<Error> wrong_effects(const std::vector<std::string>& wanted) {
  if (wanted.empty() || wanted == std::vector<std::string>{""}) return wrong("no effect is named");
  const std::vector<std::string> known = effect_names();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const std::string& name = wanted[i];
    const bool alone = name == "auto" || name == "none";
    if (alone && wanted.size() > 1) return wrong("\"" + name + "\" stands alone");
    if (!alone && !is_among(known, name))
      return wrong("there is no effect named \"" + name + "\"" + meant(name, known));
    if (is_among({wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(i)}, name))
      return wrong("\"" + name + "\" is named twice");
  }
  return std::nullopt;
}

}  // namespace odomcalib::calib::terms
