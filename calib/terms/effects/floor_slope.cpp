#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Rolling slip under gravity: downhill creep ds = -|ds| (k_x cos(heading) + k_y sin(heading)).
// A property of the place: reported, never written back.
class FloorSlope final : public StepEffect<FloorSlope> {
 public:
  FloorSlope() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "floor_slope",
            .parameters =
                {{.name = "kappa_x",
                  .unit = "1",
                  .scale = 0.015,
                  .lower = -0.1,
                  .upper = 0.1,
                  .meaning = {.label = "along x",
                              .factor = 100.0,
                              .unit = "%",
                              .is = "share of its way that the robot creeps back when it heads along x",
                              .said = "on this floor the robot creeps [back|on] by {} of its way along x"}},
                 {.name = "kappa_y",
                  .unit = "1",
                  .scale = 0.015,
                  .lower = -0.1,
                  .upper = 0.1,
                  .meaning = {.label = "along y",
                              .factor = 100.0,
                              .unit = "%",
                              .is = "share of its way that the robot creeps back when it heads along y",
                              .said = "on this floor the robot creeps [back|on] by {} of its way along y"}}},
            .aliases = {"carpet"},
            .separating_motion = "straight lines on four headings, forward and backward on each",
            .manoeuvre = "headings",
            .dependences = {{vehicle::Covariate::heading, vehicle::Channel::both_path}},
            .storage = vehicle::Storage::nowhere};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double path = std::abs(c.speed) * c.dt;
    const T creep = -path * (p[0] * c.heading_cosine + p[1] * c.heading_sine);
    step.left += creep;
    step.right += creep;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_floor_slope() { return std::make_shared<FloorSlope>(); }

}  // namespace odomcalib::calib::terms
