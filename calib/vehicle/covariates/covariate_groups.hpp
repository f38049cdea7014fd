// Groups of covariates of the drive so far, computed as a model needs them: most serve one or two terms.
#pragma once

#include "calib/vehicle/enum_set.hpp"

namespace odomcalib::calib::vehicle {

/// Covariates that are computed together.
enum class CovariateGroup : unsigned {
  acceleration_changes,
  sway,
  tyre_relaxation,
  gear_play,
  stops,
  winding,  ///< begins where a stop does: computed beside `stops` only
  previous_turn,
  previous_acceleration,
  caster,
};
inline constexpr CovariateGroup kLastCovariateGroup = CovariateGroup::caster;

using CovariateGroups = EnumSet<CovariateGroup>;
inline constexpr CovariateGroups kAllCovariateGroups = CovariateGroups::up_to(kLastCovariateGroup);

}  // namespace odomcalib::calib::vehicle
