#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// An off-centre mass or one worn tyre makes left and right turns scrub differently: b (1 + kappa [omega >
// 0]).
class TurnDirectionAsymmetry final : public StepEffect<TurnDirectionAsymmetry> {
 public:
  TurnDirectionAsymmetry() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {
        .name = "turn_direction_asymmetry",
        .parameters =
            {{.name = "kappa",
              .unit = "1",
              .scale = 5e-3,
              .lower = -0.3,
              .upper = 0.3,
              .meaning =
                  {.factor = 100.0,
                   .unit = "%",
                   .is =
                       "share by which the effective track width is larger in left turns than in right ones",
                   .said =
                       "the effective track width is {} [larger|smaller] in left turns than in right ones"}}},
        .aliases = {"scan_skew", "direction_dependent_diameter"},
        .separating_motion = "turns both ways at two or more rates: skew grows with the rate, scrub does not",
        .manoeuvre = "turns",
        .dependences = {{vehicle::Covariate::turn_rate, vehicle::Channel::track}},
        .has_two_states = true};
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
