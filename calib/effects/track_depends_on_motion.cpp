#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// In a spin the whole contact patch scrubs, rolling forward re-lays it: b (1 + kappa s) with s = |omega| b /
// (|omega| b + 2 |v|), 1 in a spin and towards 0 in a wide arc. |omega| b is the difference of the wheel
// speeds.
class TrackDependsOnMotion final : public StepEffect<TrackDependsOnMotion> {
 public:
  [[nodiscard]] std::string name() const override { return "track_depends_on_motion"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"kappa", "1", 0.01, -0.9, 0.9}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"tick_loss", "speed_dependent_radius", "speed_dependent_track"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "spins and arcs with equal wheel speeds";
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::turn_rate, Carrier::track}, {Variable::speed, Carrier::track}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    const double difference = std::abs(c.right_speed - c.left_speed);
    const double sum = std::abs(c.right_speed + c.left_speed);
    const double share = difference + sum > 1e-3 ? difference / (difference + sum) : 0.0;
    step.track *= 1.0 + p[0] * share;
  }
};

}  // namespace

std::shared_ptr<const Effect> make_track_depends_on_motion() {
  return std::make_shared<TrackDependsOnMotion>();
}

}  // namespace odomcalib::calib
