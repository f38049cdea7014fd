#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Wide soft contacts and casters change the effective track width with the turn rate: b (1 + kappa |omega|).
class SpeedDependentTrack final : public StepEffect<SpeedDependentTrack> {
 public:
  [[nodiscard]] std::string name() const override { return "speed_dependent_track"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"kappa", "s/rad", 0.01, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"track_depends_on_motion", "speed_dependent_radius"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "spins at three rates, and arcs at the same turn rate and different speeds";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "turns"; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::turn_rate, vehicle::Channel::track}};
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
