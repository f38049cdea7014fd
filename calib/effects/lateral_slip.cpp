#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// The contacts yield sideways under centripetal force: dy = -k omega ds.
class LateralSlip final : public StepEffect<LateralSlip> {
 public:
  [[nodiscard]] std::string name() const override { return "lateral_slip"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"k", "s", 0.01, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"toe", "icr_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "arcs left and right, forward and backward, at two speeds and two radii";
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    step.side -= p[0] * c.turn_rate * c.speed * c.dt;
  }
};

}  // namespace

std::shared_ptr<const Effect> make_lateral_slip() { return std::make_shared<LateralSlip>(); }

}  // namespace odomcalib::calib
