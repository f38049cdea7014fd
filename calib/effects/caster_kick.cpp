#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// Trailing casters swing through half a turn after a reversal and push the chassis aside: the yaw added after
// the distance s since the reversal falls off as exp(-s / length), with a length of two to four caster
// trails.
class CasterKick final : public StepEffect<CasterKick> {
 public:
  [[nodiscard]] std::string name() const override { return "caster_kick"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"kappa", "rad", 0.01, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"backlash", "time_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "reversals straight after a left and after a right arc, and long straights after a reversal";
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    constexpr double kLength = 0.08;  // m; detection hardly depends on it between 0.04 and 0.15 m
    step.yaw +=
        p[0] * c.direction * (std::abs(c.speed) * c.dt / kLength) * std::exp(-c.since_reversal / kLength);
  }
};

}  // namespace

std::shared_ptr<const Effect> make_caster_kick() { return std::make_shared<CasterKick>(); }

}  // namespace odomcalib::calib
