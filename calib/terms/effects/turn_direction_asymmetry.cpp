#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// An off-centre mass or one worn tyre makes left and right turns scrub differently: b (1 + kappa [omega >
// 0]).
class TurnDirectionAsymmetry final : public StepEffect<TurnDirectionAsymmetry> {
 public:
  [[nodiscard]] std::string name() const override { return "turn_direction_asymmetry"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"kappa", "1", 5e-3, -0.3, 0.3}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"scan_skew", "direction_dependent_diameter"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "turns both ways at two or more rates: skew grows with the rate, scrub does not";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "turns"; }
  [[nodiscard]] bool has_two_states() const override { return true; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::turn_rate, vehicle::Channel::track}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    if (c.turn_rate > 0.0) step.track *= 1.0 + p[0];
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_turn_direction_asymmetry() {
  return std::make_shared<TurnDirectionAsymmetry>();
}

}  // namespace odomcalib::calib::terms
