#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// A viscoelastic tyre rolls on a radius that changes with its speed: dL' = dL (1 + kappa |u_L|) by the
// textbook. One that has stiffened as far as it will once it rolls fast (Ferry, Viscoelastic Properties of
// Polymers, 1980, chapter 3: the storage modulus of a Maxwell element) grows by kappa h u^2 / (u^2 + h^2)
// instead.
class SpeedDependentRadius final : public StepEffect<SpeedDependentRadius> {
 public:
  /// @param half_speed at which half of the growth is reached, m/s; 0: the textbook's function
  explicit SpeedDependentRadius(double half_speed) : StepEffect(row(half_speed)) {}

  static vehicle::EffectRow row(double half_speed) {
    return {
        .name = "speed_dependent_radius",
        .parameters = {{.name = "kappa",
                        .unit = "s/m",
                        .scale = 0.01,
                        .lower = -1.0,
                        .upper = 1.0,
                        .meaning = {.factor = 100.0,
                                    .unit = "% at 1 m/s",
                                    .is = "share by which both wheels grow per m/s",
                                    .said = "both wheels [grow|shrink] by {}"}},
                       {.name = "half_speed",
                        .unit = "m/s",
                        .scale = 1e9,
                        .lower = 0.0,
                        .upper = 10.0,
                        .start = half_speed,
                        .fixed = true,
                        .meaning = {.label = "half of it at",
                                    .unit = "m/s",
                                    .is = "speed at which half of the growth is reached; 0: it has no end"}}},
        .aliases = {"track_depends_on_motion", "tick_loss"},
        .separating_motion =
            "straight lines at three speeds over 1:3, and spins whose wheel speeds overlap those of the "
            "straights",
        .manoeuvre = "straights",
        .dependences = {vehicle::kOfEachWheel,
                        {vehicle::Covariate::left_speed, vehicle::Channel::left_travel},
                        {vehicle::Covariate::right_speed, vehicle::Channel::right_travel},
                        {vehicle::Covariate::speed, vehicle::Channel::both_travel}}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double half_speed : {0.0, 0.1, 0.2, 0.4, 0.8})
      all.push_back(std::make_shared<SpeedDependentRadius>(half_speed));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.left *= 1.0 + p[0] * growth(std::abs(c.left_speed), p[1]);
    step.right *= 1.0 + p[0] * growth(std::abs(c.right_speed), p[1]);
  }

 private:
  template <typename T>
  static T growth(double speed, const T& half_speed) {
    if (!(plain(half_speed) > 0.0)) return T(speed);
    return half_speed * speed * speed / (speed * speed + half_speed * half_speed);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_speed_dependent_radius() {
  return std::make_shared<SpeedDependentRadius>(0.0);
}

}  // namespace odomcalib::calib::terms
