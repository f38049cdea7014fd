#include "calib/selection/lidar_report.hpp"

#include <nlohmann/json.hpp>

namespace odomcalib::calib::selection {

std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings) {
  std::vector<EffectResult> all;
  for (const terms::LidarFinding& finding : findings) {
    if (!finding.effect->is_named()) continue;
    EffectResult result;
    result.name = finding.effect->name();
    result.parameters = finding.effect->quantities(finding.values, finding.deviations);
    result.aliases = finding.effect->aliases();
    result.evidence = {finding.family_p_value, finding.before, finding.after};
    all.push_back(std::move(result));
  }
  return all;
}

std::string lidar_smooth_terms_to_json(const std::vector<terms::LidarFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const terms::LidarFinding& finding : findings) {
    if (finding.effect->is_named()) continue;
    nlohmann::ordered_json coefficients = nlohmann::ordered_json::object();
    const auto parameters = finding.effect->parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) coefficients[parameters[k].name] = finding.values[k];
    list.push_back({{"variable", finding.effect->name()},
                    {"law_of_a_name", completes(finding, findings)},
                    {"corrected", finding.effect->is_correctable()},
                    {"held_out_before", finding.before},
                    {"held_out_after", finding.after},
                    {"coefficients", coefficients}});
  }
  return list.dump();
}

}  // namespace odomcalib::calib::selection
