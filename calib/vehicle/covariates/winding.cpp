#include "calib/vehicle/covariates/winding.hpp"

#include <algorithm>
#include <cmath>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {

/// The state follows the motion over a distance of its own.
void Winding::wind_up(const Rims& rims, const math::Pose& step) {
  const auto [left, right, speed] = rims;
  const double way = std::abs(left) + std::abs(right);
  const auto follow = [](double& state, double aim, double motion) {
    state -= std::expm1(-motion) * (aim - state);
  };
  if (!(way > 0.0)) return;
  auto& [brief, lasting] = wound_;
  follow(brief.way, (left + right) / way, 0.5 * way / settings::kWindWay_m);
  follow(brief.turn, (right - left) / way, 0.5 * way / settings::kWindWay_m);
  follow(lasting.way, std::copysign(1.0, step.x), std::abs(step.x) / settings::kWindWay_m);
  follow(lasting.turn, std::copysign(1.0, step.yaw), std::abs(step.yaw) / settings::kWindTurn_rad);
}

std::array<ReleasedWinding, kWindings> Winding::unwind(double duration) {
  std::array<ReleasedWinding, kWindings> unwound{};
  const double share = -std::expm1(-duration / settings::kUnwind_s);
  for (std::size_t k = 0; k < kWindings; ++k) {
    unwound[k] = {share * wound_[k].way, share * wound_[k].turn};
    wound_[k].way -= unwound[k].way;
    wound_[k].turn -= unwound[k].turn;
  }
  return unwound;
}

std::array<ReleasedWinding, kWindings> Winding::advance(const Standstill& standstill, const Rims& rims,
                                                        const math::Pose& step, double dt) {
  const bool moves = standstill.stood() == 0.0;
  if (standstill.sets_off()) fastest_ = 0.0;
  if (moves) fastest_ = std::max(fastest_, rims.speed);
  if (moves) wind_up(rims, step);
  return unwind(std::min(standstill.stood(), dt));
}

}  // namespace odomcalib::calib::vehicle
