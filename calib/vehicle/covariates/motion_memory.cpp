#include "calib/vehicle/covariates/motion_memory.hpp"

#include <cmath>
#include <span>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {
namespace {

/// Means of a motion's sign move on by the motion, in units of the usual span.
void remember(std::span<double> memory, double motion) {
  for (std::size_t k = 0; k < kMemorySpans.size(); ++k)
    memory[k] -= std::expm1(-std::abs(motion) / kMemorySpans[k]) * (std::copysign(1.0, motion) - memory[k]);
}

}  // namespace

void PreviousTurn::advance(double yaw) { remember(memory_, yaw); }

/// Noise of the acceleration at steady speed must not wash the memory out.
void PreviousAcceleration::advance(double acceleration, double peak, double dt) {
  if (std::abs(acceleration) > kAccelerationThresholds.front())
    remember(memory_.means, acceleration * dt / settings::kAccelerationMemory_m_s);
  for (std::size_t k = 0; k < kAccelerationThresholds.size(); ++k)
    if (std::abs(peak) > kAccelerationThresholds[k]) memory_.relays[k] = peak > 0.0 ? 1 : -1;
}

}  // namespace odomcalib::calib::vehicle
