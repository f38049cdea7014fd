#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

/// A counter that misses edges above a wheel speed: dL' = dL (1 + kappa_L [|u_L| > threshold]). The step has
/// a width: that over which the smoothed speed changes anyway, or more.
class TickLoss final : public StepEffect<TickLoss> {
 public:
  explicit TickLoss(double threshold) : StepEffect(row(threshold)) {}

  static vehicle::EffectRow row(double threshold) {
    return {
        .name = "tick_loss",
        .parameters =
            {{.name = "left_kappa",
              .unit = "1",
              .scale = 0.01,
              .lower = -0.3,
              .upper = 0.3,
              .meaning =
                  {.label = "left encoder",
                   .factor = 100.0,
                   .unit = "%",
                   .is = "share by which the left wheel goes further than it counts, above the threshold",
                   .said = "left encoder counts {} too [few|many] at speed"}},
             {.name = "right_kappa",
              .unit = "1",
              .scale = 0.01,
              .lower = -0.3,
              .upper = 0.3,
              .meaning =
                  {.label = "right encoder",
                   .factor = 100.0,
                   .unit = "%",
                   .is = "share by which the right wheel goes further than it counts, above the threshold",
                   .said = "right encoder counts {} too [few|many] at speed"}},
             {.name = "threshold",
              .unit = "m/s",
              .scale = 1e9,
              .lower = 0.02,
              .upper = 5.0,
              .start = threshold,
              .meaning = {.label = "from a speed of",
                          .unit = "m/s",
                          .is = "speed of the wheel above which counts are lost"}},
             {.name = "width",
              .unit = "m/s",
              .scale = 1e9,
              .lower = -0.2,
              .upper = 0.2,
              .start = kWidth,
              .meaning = {.label = "sets in over",
                          .unit = "m/s",
                          .is = "range of speed over which the loss sets in"}}},
        .aliases = {"speed_dependent_radius", "track_depends_on_motion"},
        .separating_motion =
            "straight lines above and below the threshold, and spins whose wheel speed stays below it",
        .manoeuvre = "straights",
        .dependences = {vehicle::kOfEachWheel,
                        {vehicle::Covariate::left_speed, vehicle::Channel::left_travel},
                        {vehicle::Covariate::right_speed, vehicle::Channel::right_travel}}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double threshold : {0.1, 0.14, 0.19, 0.25, 0.32, 0.4, 0.5, 0.7, 1.0, 1.5})
      all.push_back(std::make_shared<TickLoss>(threshold));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.left *= 1.0 + p[0] * above(std::abs(c.left_speed), p[2], p[3]);
    step.right *= 1.0 + p[1] * above(std::abs(c.right_speed), p[2], p[3]);
  }

 private:
  static constexpr double kWidth = 0.03;     // m/s
  static constexpr double kSharpest = 0.01;  // m/s

  /// However sharp the step is, the speed that is compared with it is a mean. The width's sign says nothing.
  template <typename T>
  static T above(double speed, const T& threshold, const T& width) {
    using std::exp;
    using std::sqrt;
    const T steps = (threshold - speed) / sqrt(width * width + kSharpest * kSharpest);
    return 1.0 / (1.0 + exp(steps));
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_tick_loss() { return std::make_shared<TickLoss>(0.25); }

}  // namespace odomcalib::calib::terms
