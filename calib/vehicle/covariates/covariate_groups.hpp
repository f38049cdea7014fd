// Groups of covariates of the drive so far, computed as a model needs them: most serve one or two terms.
#pragma once

#include <initializer_list>

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

class CovariateGroups {
 public:
  constexpr CovariateGroups() = default;
  constexpr CovariateGroups(std::initializer_list<CovariateGroup> groups) {
    for (const CovariateGroup group : groups) bits_ |= bit(group);
  }
  static constexpr CovariateGroups all() {
    CovariateGroups groups;
    groups.bits_ = 2U * bit(kLastCovariateGroup) - 1U;
    return groups;
  }

  [[nodiscard]] constexpr bool contain(CovariateGroup group) const { return (bits_ & bit(group)) != 0; }
  constexpr CovariateGroups& operator|=(CovariateGroups others) {
    bits_ |= others.bits_;
    return *this;
  }
  [[nodiscard]] constexpr CovariateGroups without(CovariateGroups others) const {
    CovariateGroups groups;
    groups.bits_ = bits_ & ~others.bits_;
    return groups;
  }
  friend constexpr bool operator==(CovariateGroups, CovariateGroups) = default;

 private:
  static constexpr unsigned bit(CovariateGroup group) { return 1U << static_cast<unsigned>(group); }
  unsigned bits_ = 0;
};

}  // namespace odomcalib::calib::vehicle
