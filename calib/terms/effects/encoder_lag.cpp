#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

/// One wheel's counts are older than the other's: two nodes on a bus that answer in turn, a filter in one of
/// two drives. What a wheel did in its lag is still to come: dL' = dL + lag/2 du_L, dR' = dR - lag/2 du_R.
/// The lag that both have is time_offset's.
class EncoderLag final : public StepEffect<EncoderLag> {
 public:
  EncoderLag() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {
        .name = "encoder_lag",
        .parameters =
            {{.name = "left_less_right",
              .unit = "s",
              .scale = 5e-3,
              .lower = -0.2,
              .upper = 0.2,
              .meaning = {.label = "left less right",
                          .factor = 1e3,
                          .unit = "ms",
                          .is = "age of the left wheel's counts less that of the right wheel's",
                          .said =
                              "counts of the left wheel are {} [older|newer] than those of the right one"}}},
        .aliases = {"backlash", "time_offset"},
        .separating_motion = "straight lines and turns on the spot with quick starts, without reversing",
        .manoeuvre = "accelerations"};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.left += 0.5 * p[0] * (c.left_acceleration * c.dt);
    step.right -= 0.5 * p[0] * (c.right_acceleration * c.dt);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_encoder_lag() { return std::make_shared<EncoderLag>(); }

}  // namespace odomcalib::calib::terms
