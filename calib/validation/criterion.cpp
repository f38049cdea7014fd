#include "calib/validation/criterion.hpp"

#include <algorithm>
#include <cmath>

#include "calib/math/settings.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {

bool is_clearly_better(const std::optional<HeldOut>& before, const std::optional<HeldOut>& after) {
  if (!before || !after) return false;
  double ratio = 1.0;
  for (std::size_t k = 0; k < before->bounded.size(); ++k) ratio *= after->bounded[k] / before->bounded[k];
  return ratio < settings::kClearlyBetter;
}

bool is_worse(const std::optional<HeldOut>& before, const std::optional<HeldOut>& after) {
  if (!before || !after) return !after && before;
  for (std::size_t k = 0; k < before->rms.size(); ++k)
    if (after->rms[k] > settings::kToleratedRms * before->rms[k]) return true;
  return false;
}

double p_value_of(const HeldOut& before, const HeldOut& after) {
  double ratio = 0.0;
  for (std::size_t k = 0; k < before.bounded.size(); ++k)
    ratio += 2.0 * static_cast<double>(after.pairs) * std::log(before.bounded[k] / after.bounded[k]);
  return std::erfc(std::sqrt(std::max(0.5 * ratio, 0.0)));
}

bool is_plain(const Estimate& estimate, double negligible) {
  const double size = std::abs(estimate.value);
  return size > negligible && size > math::settings::kClearSigmas * std::sqrt(estimate.variance);
}

bool is_idle(const Estimate& estimate, double negligible) {
  const double deviation = std::sqrt(estimate.variance);
  return std::abs(estimate.value) <= std::max(math::settings::kClearSigmas * deviation, negligible);
}

bool is_mounted_elsewhere(const MountingOffset& mounting) {
  const auto is_known = [](const Estimate& of, double known) { return std::sqrt(of.variance) < known; };
  return is_known(mounting.x, settings::kKnownMounting_m) &&
         is_known(mounting.y, settings::kKnownMounting_m) &&
         is_known(mounting.yaw, settings::kKnownMounting_rad) &&
         (is_plain(mounting.x, settings::kNegligibleMounting_m) ||
          is_plain(mounting.y, settings::kNegligibleMounting_m) ||
          is_plain(mounting.yaw, settings::kNegligibleMounting_rad));
}

bool is_sliding(double drift) { return drift >= settings::kSliding; }

bool agrees(const Estimate& one, const Estimate& other) {
  const double apart = other.value - one.value;
  return !(apart * apart >
           math::settings::kClearSigmas * math::settings::kClearSigmas * (one.variance + other.variance));
}

bool confirms_and_knows_better(std::span<const Comparison> parameters) {
  double gain = 0.0;
  for (const auto& [before, after, adds_to_gain] : parameters) {
    if (!(before.variance > 0.0) || !(after.variance > 0.0)) continue;
    if (!agrees(before, after)) return false;
    if (adds_to_gain) gain += std::log(before.variance / after.variance);
  }
  return gain > 0.0;
}

}  // namespace odomcalib::calib::validation
