#include "calib/vehicle/covariates/sway.hpp"

#include <cmath>
#include <cstddef>

namespace odomcalib::calib::vehicle {

void SwayLag::advance(Sways& before, Sways& after, double dt) {
  for (std::size_t k = 0; k < kSwayLags.size(); ++k) {
    if (kSwayLags[k] == 0.0) continue;
    before[k] = bend_[k];
    bend_[k] -= std::expm1(-dt / kSwayLags[k]) * (after[k] - bend_[k]);
    after[k] = bend_[k];
  }
}

}  // namespace odomcalib::calib::vehicle
