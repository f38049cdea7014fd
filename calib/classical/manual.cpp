#include "calib/classical/manual.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/classical/settings.hpp"
#include "calib/math/median.hpp"

namespace odomcalib::calib::classical {
namespace {

struct Comparison {
  double claimed = 0.0;
  double seen = 0.0;
};

/// Slope through the origin of `seen` on `claimed`, after cutting what deviates grossly from the median
/// ratio.
Ratio robust_slope(const std::vector<Comparison>& all) {
  std::vector<double> ratios;
  ratios.reserve(all.size());
  for (const Comparison& c : all) ratios.push_back(c.seen / c.claimed);
  const double centre = math::median_of(ratios);
  std::vector<double> deviations;
  deviations.reserve(all.size());
  for (const Comparison& c : all) deviations.push_back(std::abs(c.seen - centre * c.claimed));
  const double limit = settings::kGrossPair * math::kMadToSigma * std::max(math::median_of(deviations), 1e-9);
  Ratio result;
  double xy = 0.0;
  double xx = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (deviations[i] > limit) {
      ++result.discarded;
      continue;
    }
    xy += all[i].claimed * all[i].seen;
    xx += all[i].claimed * all[i].claimed;
    ++result.used;
  }
  result.value = xy / xx;
  double squares = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (deviations[i] <= limit) squares += std::pow(all[i].seen - result.value * all[i].claimed, 2);
  const double dof = std::max(static_cast<double>(result.used) - 1.0, 1.0);
  result.rms = std::sqrt(squares / static_cast<double>(result.used));
  result.std = std::sqrt(squares / dof / xx);
  return result;
}

}  // namespace

Result<Ratio> straight_ratio(std::span<const wheels::WheelMotion> samples,
                             const wheels::BaseParameters& nominal) {
  std::vector<Comparison> straight;
  double travel = 0.0;
  for (const wheels::WheelMotion& sample : samples) {
    const double left = nominal.left_radius * sample.left;
    const double right = nominal.right_radius * sample.right;
    const double claimed = (left + right) / 2.0;
    if (std::abs(sample.sensor_motion.yaw) > settings::kStraightYaw_rad ||
        std::abs(claimed) < settings::kLeastPairTravel_m || left * right <= 0.0)
      continue;
    straight.push_back({std::abs(claimed), std::hypot(sample.sensor_motion.x, sample.sensor_motion.y)});
    travel += std::abs(claimed);
  }
  if (travel < settings::kLeastTravel_m)
    return Error{ErrorCode::refused, "only " + std::to_string(travel) + " m were driven straight",
                 "straight method", "drive at least 0.3 m straight"};
  return robust_slope(straight);
}

Result<Ratio> spin_ratio(std::span<const wheels::WheelMotion> samples, const wheels::BaseParameters& base) {
  std::vector<Comparison> turns;
  double turned = 0.0;
  for (const wheels::WheelMotion& sample : samples) {
    const double left = base.left_radius * sample.left;
    const double right = base.right_radius * sample.right;
    const double claimed = (right - left) / base.track_width;
    const double lever = std::abs(left + right) / 2.0;
    if (std::abs(claimed) < settings::kLeastPairTurn_rad ||
        lever > settings::kSpinLever * base.track_width * std::abs(claimed))
      continue;
    turns.push_back({sample.sensor_motion.yaw, claimed});
    turned += std::abs(claimed);
  }
  if (turned < settings::kLeastTurn_rad)
    return Error{ErrorCode::refused,
                 "only " + std::to_string(turned * 180.0 / math::kPi) + " degrees were turned on the spot",
                 "spin method", "turn at least a quarter turn on the spot, better one turn each way"};
  return robust_slope(turns);
}

}  // namespace odomcalib::calib::classical
