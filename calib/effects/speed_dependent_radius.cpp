#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// A viscoelastic tyre rolls on a radius that changes with its speed: dL' = dL (1 + kappa |u_L|).
class SpeedDependentRadius final : public StepEffect<SpeedDependentRadius> {
 public:
  [[nodiscard]] std::string name() const override { return "speed_dependent_radius"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"kappa", "s/m", 0.01, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"track_depends_on_motion", "tick_loss"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "straight lines at three speeds over 1:3, and spins whose wheel speeds overlap those of the "
           "straights";
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::left_speed, Carrier::left_travel},
            {Variable::right_speed, Carrier::right_travel},
            {Variable::speed, Carrier::both_travel}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    step.left *= 1.0 + p[0] * std::abs(c.left_speed);
    step.right *= 1.0 + p[0] * std::abs(c.right_speed);
  }
};

}  // namespace

std::shared_ptr<const Effect> make_speed_dependent_radius() {
  return std::make_shared<SpeedDependentRadius>();
}

}  // namespace odomcalib::calib
