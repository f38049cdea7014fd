#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

/// The motor turns through the play before the wheel follows: after each reversal of a wheel that wheel
/// misses the play g, whatever its speed. The loss is spread over the first hundredths of a radian, which for
/// g of that size no sampling can tell from a step.
class Backlash final : public StepEffect<Backlash> {
 public:
  [[nodiscard]] std::string name() const override { return "backlash"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"left_play", "rad", 0.02, -0.3, 0.3}, {"right_play", "rad", 0.02, -0.3, 0.3}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"time_offset", "caster_kick"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "reversals at low and high speed; spins left and right, where the wheels reverse and the robot "
           "does not";
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::left_since_reversal, Carrier::left_travel},
            {Variable::right_since_reversal, Carrier::right_travel}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    lose(c.left_since_reversal, c.left_delta, p[0], step.left);
    lose(c.right_since_reversal, c.right_delta, p[1], step.right);
  }

 private:
  template <typename T>
  static void lose(double since, double delta, const T& play, T& travel) {
    constexpr double kSpread = 0.02;  // rad
    if (since > 20.0 * kSpread || std::abs(delta) < 1e-9) return;
    const double share = std::exp(-since / kSpread) - std::exp(-(since + std::abs(delta)) / kSpread);
    travel *= 1.0 - play * (share / std::abs(delta));
  }
};

}  // namespace

std::shared_ptr<const Effect> make_backlash() { return std::make_shared<Backlash>(); }

}  // namespace odomcalib::calib
