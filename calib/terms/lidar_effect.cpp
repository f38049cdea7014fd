#include "calib/terms/lidar_effect.hpp"

#include <algorithm>

namespace odomcalib::calib::terms {

BeamShift LidarEffect::total(const Sighting& sighting, std::span<const double> values) const {
  BeamShift sum;
  const std::vector<BeamShift> units = shifts(sighting);
  for (std::size_t k = 0; k < units.size(); ++k) {
    sum.radial += values[k] * units[k].radial;
    sum.angular += values[k] * units[k].angular;
  }
  return sum;
}

std::vector<std::pair<std::string, Quantity>> LidarEffect::quantities(
    std::span<const double> values, std::span<const double> deviations) const {
  std::vector<std::pair<std::string, Quantity>> out;
  const std::vector<LidarParameter>& list = parameters();
  for (std::size_t k = 0; k < list.size(); ++k)
    out.push_back({list[k].name, {values[k], deviations[k], list[k].unit}});
  return out;
}

std::vector<double> LidarEffect::values_of(const QuantityList& stated) const {
  if (stated.size() != parameters().size()) return {};
  std::vector<double> values;
  for (const auto& [name, quantity] : stated) values.push_back(quantity.value);
  return values;
}

bool completes(const LidarFinding& finding, const std::vector<LidarFinding>& all) {
  return !finding.effect->is_named() && std::any_of(all.begin(), all.end(), [&](const LidarFinding& other) {
    return other.effect->is_named() && other.effect->covariate() == finding.effect->covariate();
  });
}

Scan corrected(const Scan& scan, const std::vector<LidarFinding>& findings) {
  Scan out = scan;
  out.angles.resize(scan.ranges.size());
  for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
    const auto range = static_cast<double>(scan.ranges[k]);
    double angle = scan.angle(k);
    double true_range = range;
    for (const LidarFinding& finding : findings) {
      if (!finding.effect->is_correctable()) continue;
      const BeamShift shift = finding.effect->total({scan.angle(k), range}, finding.values);
      true_range -= shift.radial;
      angle -= shift.angular;
    }
    out.angles[k] = static_cast<float>(angle);
    if (range > 0.0) out.ranges[k] = static_cast<float>(std::max(true_range, 0.0));
  }
  return out;
}

}  // namespace odomcalib::calib::terms
