// Covariates of which an interval has dozens of values, and that one effect each asks for: no interval holds
// them itself.
#pragma once

#include <cstddef>

#include "calib/vehicle/covariates/caster_swing.hpp"
#include "calib/vehicle/covariates/gear_play.hpp"

namespace odomcalib::calib::vehicle {

/// Rotation of each wheel in an interval that a gear train with each of kPlays loses, rad.
struct LostByWheels {
  LostToPlay left{}, right{};
};

inline constexpr LostByWheels kNothingLost{};
inline constexpr CasterSines kNoSwing{};

class OnDemand {
 public:
  OnDemand() = default;
  virtual ~OnDemand() = default;
  OnDemand(const OnDemand&) = delete;
  OnDemand& operator=(const OnDemand&) = delete;
  [[nodiscard]] virtual const LostByWheels& lost_to_play(std::size_t interval) const = 0;
  [[nodiscard]] virtual const CasterSines& caster(std::size_t interval) const = 0;
};

}  // namespace odomcalib::calib::vehicle
