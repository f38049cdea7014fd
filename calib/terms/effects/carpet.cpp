#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Fibres lean: each metre of travel shifts the robot in a direction fixed in the room, (p_x, p_y) |ds|.
// A property of the place: reported, never written back.
class Carpet final : public StepEffect<Carpet> {
 public:
  Carpet() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "carpet",
            .parameters = {{.name = "p_x",
                            .unit = "1",
                            .scale = 0.015,
                            .lower = -0.2,
                            .upper = 0.2,
                            .meaning = {.label = "along x",
                                        .factor = 1e3,
                                        .unit = "mm a metre",
                                        .is = "way along x of the room, per metre driven on any heading",
                                        .said = "on this floor the robot is carried {} along [x|minus x]"}},
                           {.name = "p_y",
                            .unit = "1",
                            .scale = 0.015,
                            .lower = -0.2,
                            .upper = 0.2,
                            .meaning = {.label = "along y",
                                        .factor = 1e3,
                                        .unit = "mm a metre",
                                        .is = "way along y of the room, per metre driven on any heading",
                                        .said = "on this floor the robot is carried {} along [y|minus y]"}}},
            .aliases = {"floor_slope"},
            .separating_motion = "straight lines on four headings",
            .manoeuvre = "headings",
            .dependences = {{vehicle::Covariate::heading, vehicle::Channel::both_path},
                            {vehicle::Covariate::heading, vehicle::Channel::sideways_path}},
            .storage = vehicle::Storage::nowhere};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double path = std::abs(c.speed) * c.dt;
    const double cosine = c.heading_cosine, sine = c.heading_sine;
    const T along = path * (p[0] * cosine + p[1] * sine);
    step.left += along;
    step.right += along;
    step.side += path * (p[1] * cosine - p[0] * sine);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_carpet() { return std::make_shared<Carpet>(); }

}  // namespace odomcalib::calib::terms
