#include "calib/terms/effects/step_effect.hpp"
#include "calib/vehicle/effect.hpp"

#include <cmath>

namespace odomcalib::calib::terms {
namespace {

enum class Side { left, right };

/// An eccentric wheel or encoder disc: dL' = dL (1 + a cos phi + b sin phi) with phi the angle of that wheel.
/// The phase is constant over a run; between runs it is known only if the counter keeps its value.
class WheelEccentricity final : public StepEffect<WheelEccentricity> {
 public:
  explicit WheelEccentricity(Side side) : StepEffect(row(side)), side_(side) {}

  static vehicle::EffectRow row(Side side) {
    const bool left = side == Side::left;
    return {
        .name = "wheel_eccentricity",
        .parameters =
            {{.name = left ? "left_cos" : "right_cos",
              .unit = "1",
              .scale = 5e-3,
              .lower = -0.1,
              .upper = 0.1,
              .meaning =
                  {.label = left ? "left wheel, cosine part" : "right wheel, cosine part",
                   .factor = 100.0,
                   .unit = "%",
                   .is = left ? "share by which the left radius varies as the wheel turns: cosine part"
                              : "share by which the right radius varies as the wheel turns: cosine part"}},
             {.name = left ? "left_sin" : "right_sin",
              .unit = "1",
              .scale = 5e-3,
              .lower = -0.1,
              .upper = 0.1,
              .meaning = {.label = left ? "left wheel, sine part" : "right wheel, sine part",
                          .factor = 100.0,
                          .unit = "%",
                          .is =
                              left
                                  ? "share by which the left radius varies as the wheel turns: sine part"
                                  : "share by which the right radius varies as the wheel turns: sine part"}}},
        .separating_motion = "slow straight lines of five or more wheel turns",
        .manoeuvre = "slow_straights",
        .dependences = {{left ? vehicle::Covariate::left_phase : vehicle::Covariate::right_phase,
                         left ? vehicle::Channel::left_travel : vehicle::Channel::right_travel}}};
  }

  template <typename T>
  void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) const {
    const double angle = side_ == Side::left ? c.left_angle : c.right_angle;
    const T factor = 1.0 + p[0] * std::cos(angle) + p[1] * std::sin(angle);
    (side_ == Side::left ? step.left : step.right) *= factor;
  }

 private:
  Side side_;
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_wheel_eccentricity_left() {
  return std::make_shared<WheelEccentricity>(Side::left);
}
std::shared_ptr<const vehicle::Effect> make_wheel_eccentricity_right() {
  return std::make_shared<WheelEccentricity>(Side::right);
}

}  // namespace odomcalib::calib::terms
