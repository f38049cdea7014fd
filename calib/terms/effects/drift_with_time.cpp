#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Warm tyres grow and a leaking one shrinks: both diameters change with time (common), and the wheels against
// each other (differential), as 1 - exp(-t / time constant), scaled to one after 100 s; a long time constant
// makes it linear.
class DriftWithTime final : public StepEffect<DriftWithTime> {
 public:
  explicit DriftWithTime(double time_constant) : StepEffect(row(time_constant)) {}

  static vehicle::EffectRow row(double time_constant) {
    return {
        .name = "drift_with_time",
        .parameters =
            {{.name = "common",
              .unit = "1/(100 s)",
              .scale = 1e-3,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "both wheels",
                          .factor = 100.0,
                          .unit = "% in 100 s",
                          .is = "share by which both diameters grow in 100 s",
                          .said = "both wheels [grow|shrink] by {}"}},
             {.name = "differential",
              .unit = "1/(100 s)",
              .scale = 1e-3,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "right against left",
                          .factor = 100.0,
                          .unit = "% in 100 s",
                          .is = "share by which the right diameter grows and the left one shrinks in 100 s",
                          .said = "the right wheel [grows|shrinks] and the left one [shrinks|grows] by {}"}},
             {.name = "time_constant",
              .unit = "s",
              .scale = 1e9,
              .lower = 1.0,
              .upper = 1e6,
              .start = time_constant,
              .fixed = true,
              .meaning = {.label = "settles in", .unit = "s", .is = "of that growth"}}},
        .separating_motion = "the same manoeuvres at the beginning, in the middle and at the end of the run",
        .dependences = {{vehicle::Covariate::time, vehicle::Channel::left_travel},
                        {vehicle::Covariate::time, vehicle::Channel::right_travel},
                        {vehicle::Covariate::time, vehicle::Channel::both_travel}},
        .storage = vehicle::Storage::nowhere,
        .carries_over = true};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double time_constant : {1e5, 120.0, 40.0})
      all.push_back(std::make_shared<DriftWithTime>(time_constant));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    using std::exp;
    const T hundreds = (1.0 - exp(-c.t / p[2])) / (1.0 - exp(-100.0 / p[2]));
    step.left *= 1.0 + hundreds * (p[0] - p[1]);
    step.right *= 1.0 + hundreds * (p[0] + p[1]);
  }

 private:
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_drift_with_time() { return std::make_shared<DriftWithTime>(1e5); }

}  // namespace odomcalib::calib::terms
