#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// The contacts yield sideways under centripetal force: viscous, dy = -k omega ds, and as tyres do at a slip
// angle, dy = -k_tyre |v| omega ds.
class LateralSlip final : public StepEffect<LateralSlip> {
 public:
  [[nodiscard]] std::string name() const override { return "lateral_slip"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"k", "s", 0.01, -0.2, 0.2}, {"k_tyre", "s^2/m", 0.01, -0.5, 0.5}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"toe", "icr_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "arcs left and right, forward and backward, at two speeds and two radii";
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::lateral_acceleration, Carrier::sideways_path},
            {Variable::lateral_acceleration, Carrier::sideways},
            {Variable::turn_rate, Carrier::sideways}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    step.side -= (p[0] + p[1] * std::abs(c.speed)) * c.turn_rate * c.speed * c.dt;
  }
};

}  // namespace

std::shared_ptr<const Effect> make_lateral_slip() { return std::make_shared<LateralSlip>(); }

}  // namespace odomcalib::calib
