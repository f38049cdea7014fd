#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Wide soft contacts and casters change the effective track width with the turn rate: b (1 + kappa |omega|).
class SpeedDependentTrack final : public StepEffect<SpeedDependentTrack> {
 public:
  SpeedDependentTrack() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "speed_dependent_track",
            .parameters =
                {{.name = "kappa",
                  .unit = "s/rad",
                  .scale = 0.01,
                  .lower = -0.2,
                  .upper = 0.2,
                  .meaning = {.factor = 100.0,
                              .unit = "% at 1 rad/s",
                              .is = "share by which the effective track width grows per rad/s of turn rate",
                              .said = "the effective track width [grows|shrinks] with the turn rate, {}"}}},
            .aliases = {"track_depends_on_motion", "speed_dependent_radius"},
            .separating_motion = "spins at three rates, and arcs at the same turn rate and different speeds",
            .manoeuvre = "turns",
            .dependences = {{vehicle::Covariate::turn_rate, vehicle::Channel::track}}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.track *= 1.0 + p[0] * std::abs(c.turn_rate);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_speed_dependent_track() {
  return std::make_shared<SpeedDependentTrack>();
}

}  // namespace odomcalib::calib::terms
