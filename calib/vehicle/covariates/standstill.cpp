#include "calib/vehicle/covariates/standstill.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {
namespace {

/// Share of the time during which a quantity that goes from one value to another is below one.
double share_below_one(double from, double to) {
  if ((from < 1.0) == (to < 1.0)) return from < 1.0 ? 1.0 : 0.0;
  return (1.0 - std::min(from, to)) / std::abs(to - from);
}

}  // namespace

Standstill::Standstill() { since_.fill(settings::kBeforeTheDrive); }

void Standstill::arrive(double relative_speed, double dt) {
  sets_off_ = relative_speed_ >= 1.0 && stood_ > 0.0;
  if (relative_speed_ >= 1.0) stood_ = 0.0;
  stood_ += dt * share_below_one(relative_speed_, relative_speed);
  relative_speed_ = relative_speed;
  for (std::size_t k = 0; k < kStops.size(); ++k)
    if (stood_ > kStops[k]) since_[k] = 0.0;
}

void Standstill::leave(double way) {
  for (double& since : since_) since += way;
}

}  // namespace odomcalib::calib::vehicle
