#include "calib/vehicle/covariates/tyre_relaxation.hpp"

#include <cmath>
#include <cstddef>

namespace odomcalib::calib::vehicle {

void TyreRelaxation::advance(double way, double turn_rate, double lateral_acceleration) {
  for (std::size_t k = 0; k < kRelaxations.size(); ++k) {
    const double share = -std::expm1(-way / kRelaxations[k]);
    turn_rate_[k] += share * (turn_rate - turn_rate_[k]);
    lateral_acceleration_[k] += share * (lateral_acceleration - lateral_acceleration_[k]);
  }
}

}  // namespace odomcalib::calib::vehicle
