#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// In a spin the whole contact patch scrubs, rolling forward re-lays it: b (1 + kappa s) with
// s = |omega| arm / (|omega| arm + |v|), 1 in a spin and towards 0 in a wide arc. The arm is half the track
// by the textbook; wide and soft patches scrub sooner, narrow and hard ones later.
class TrackDependsOnMotion final : public StepEffect<TrackDependsOnMotion> {
 public:
  explicit TrackDependsOnMotion(double arm) : StepEffect(row(arm)) {}

  static vehicle::EffectRow row(double arm) {
    return {
        .name = "track_depends_on_motion",
        .parameters =
            {{.name = "kappa",
              .unit = "1",
              .scale = 0.01,
              .lower = -0.9,
              .upper = 0.9,
              .meaning =
                  {.factor = 100.0,
                   .unit = "%",
                   .is = "share by which the effective track width is larger in a spin than in a wide bend",
                   .said = "the effective track width is {} [larger|smaller] in a spin than in a wide bend"}},
             {.name = "arm",
              .unit = "tracks",
              .scale = 1e9,
              .lower = 0.0,
              .upper = 10.0,
              .start = arm,
              .fixed = true,
              .meaning = {.label = "half of it at a bend of",
                          .unit = "track widths",
                          .is = "radius of the bend that is half a spin, in track widths"}}},
        .aliases = {"tick_loss", "speed_dependent_radius", "speed_dependent_track"},
        .separating_motion = "spins and arcs with equal wheel speeds",
        .manoeuvre = "arcs",
        .dependences = {{vehicle::Covariate::turn_rate, vehicle::Channel::track},
                        {vehicle::Covariate::speed, vehicle::Channel::track}}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double arm : {0.5, 0.25, 1.0, 2.0}) all.push_back(std::make_shared<TrackDependsOnMotion>(arm));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const T turning = std::abs(c.right_speed - c.left_speed) * p[1];  // |omega| arm
    const double rolling = 0.5 * std::abs(c.right_speed + c.left_speed);
    if (plain(turning) + rolling > 5e-4) step.track *= 1.0 + p[0] * turning / (turning + rolling);
  }

 private:
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_track_depends_on_motion() {
  return std::make_shared<TrackDependsOnMotion>(0.5);
}

}  // namespace odomcalib::calib::terms
