#include "calib/vehicle/covariates/gear_play.hpp"

#include <algorithm>
#include <cstddef>

namespace odomcalib::calib::vehicle {

/// The play operator (Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989, section 2). What a
/// standing wheel shows of two counts is no motion, so a play of less loses its share of what is one. The
/// drive begins with the flanks that its first motion needs.
LostToPlay GearPlay::advance(double delta, double dither) {
  LostToPlay lost{};
  if (delta == 0.0) return lost;
  for (std::size_t k = 0; k < kPlays.size(); ++k) {
    const double play = std::max(kPlays[k], dither);
    if (!has_moved_) gap_[k] = delta > 0.0 ? play : 0.0;
    const double moved = gap_[k] + delta;
    const double pushed = moved > play ? moved - play : std::min(moved, 0.0);
    gap_[k] = moved - pushed;
    lost[k] = (delta - pushed) * kPlays[k] / play;
  }
  has_moved_ = true;
  return lost;
}

}  // namespace odomcalib::calib::vehicle
