#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Tread, tyre lay or load make a wheel roll differently forward and backward: dL' = dL (1 + kappa_L
// [backward]). Without backward motion it does not exist: the diameters absorb it.
class DirectionDependentDiameter final : public StepEffect<DirectionDependentDiameter> {
 public:
  [[nodiscard]] std::string name() const override { return "direction_dependent_diameter"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"left_kappa", "1", 5e-3, -0.2, 0.2}, {"right_kappa", "1", 5e-3, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"turn_direction_asymmetry", "scan_skew"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "straight lines forward and backward at the same speed, and spins both ways";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "straights"; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {vehicle::kOfEachWheel,
            {vehicle::Covariate::left_speed, vehicle::Channel::left_travel},
            {vehicle::Covariate::right_speed, vehicle::Channel::right_travel},
            {vehicle::Covariate::speed, vehicle::Channel::both_travel},
            {vehicle::Covariate::left_since_reversal, vehicle::Channel::left_travel},
            {vehicle::Covariate::right_since_reversal, vehicle::Channel::right_travel},
            {vehicle::Covariate::since_reversal, vehicle::Channel::both_travel}};
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
