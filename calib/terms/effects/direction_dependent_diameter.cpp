#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Tread, tyre lay or load make a wheel roll differently forward and backward: dL' = dL (1 + kappa_L
// [backward]). Without backward motion it does not exist: the diameters absorb it.
class DirectionDependentDiameter final : public StepEffect<DirectionDependentDiameter> {
 public:
  DirectionDependentDiameter() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "direction_dependent_diameter",
            .parameters = {{.name = "left_kappa",
                            .unit = "1",
                            .scale = 5e-3,
                            .lower = -0.2,
                            .upper = 0.2,
                            .meaning = {.label = "left wheel",
                                        .factor = 100.0,
                                        .unit = "%",
                                        .is = "share by which the left wheel is larger when it rolls back",
                                        .said = "left wheel {} [larger|smaller] when it rolls back"}},
                           {.name = "right_kappa",
                            .unit = "1",
                            .scale = 5e-3,
                            .lower = -0.2,
                            .upper = 0.2,
                            .meaning = {.label = "right wheel",
                                        .factor = 100.0,
                                        .unit = "%",
                                        .is = "share by which the right wheel is larger when it rolls back",
                                        .said = "right wheel {} [larger|smaller] when it rolls back"}}},
            .aliases = {"turn_direction_asymmetry", "scan_skew"},
            .separating_motion = "straight lines forward and backward at the same speed, and spins both ways",
            .manoeuvre = "straights",
            .dependences = {vehicle::kOfEachWheel,
                            {vehicle::Covariate::left_speed, vehicle::Channel::left_travel},
                            {vehicle::Covariate::right_speed, vehicle::Channel::right_travel},
                            {vehicle::Covariate::speed, vehicle::Channel::both_travel},
                            {vehicle::Covariate::left_since_reversal, vehicle::Channel::left_travel},
                            {vehicle::Covariate::right_since_reversal, vehicle::Channel::right_travel},
                            {vehicle::Covariate::since_reversal, vehicle::Channel::both_travel}}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    if (c.left_delta < 0.0) step.left *= 1.0 + p[0];
    if (c.right_delta < 0.0) step.right *= 1.0 + p[1];
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_direction_dependent_diameter() {
  return std::make_shared<DirectionDependentDiameter>();
}

}  // namespace odomcalib::calib::terms
