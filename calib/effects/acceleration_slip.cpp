#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// A rubber contact transmits force only with slip, and slip grows with the force: dL' = dL (1 - k sgn(u_L)
// du_L/dt).
class AccelerationSlip final : public StepEffect<AccelerationSlip> {
 public:
  [[nodiscard]] std::string name() const override { return "acceleration_slip"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"k", "s^2/m", 0.01, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"time_offset", "encoder_lag"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "equal accelerations at low and at high speed";
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::left_acceleration, Carrier::left_path},
            {Variable::right_acceleration, Carrier::right_path}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    step.left *= 1.0 - p[0] * std::copysign(c.left_acceleration, c.left_acceleration * c.left_speed);
    step.right *= 1.0 - p[0] * std::copysign(c.right_acceleration, c.right_acceleration * c.right_speed);
  }
};

}  // namespace

std::shared_ptr<const Effect> make_acceleration_slip() { return std::make_shared<AccelerationSlip>(); }

}  // namespace odomcalib::calib
