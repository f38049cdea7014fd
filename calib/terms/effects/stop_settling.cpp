#include "calib/terms/effects/step_effect.hpp"
#include "proto/angles.hpp"

namespace odomcalib::calib::terms {
namespace {

// Parts that a motion has wound up, such as the side walls of tyres in a turn on the spot, unwind after it
// (negative sizes), and a robot on a slack gear rolls on (positive ones): a little motion after each stop
// that no encoder counts.
class StopSettling final : public StepEffect<StopSettling> {
 public:
  /// @param lasting whether a turn stays wound up until another
  /// @param speed at which the sizes are stated where they grow with the speed before the stop, m/s; 0: they
  /// do not
  StopSettling(bool lasting, double speed) : StepEffect(row(lasting, speed)) {}

  static vehicle::EffectRow row(bool lasting, double speed) {
    return {.name = "stop_settling",
            .parameters =
                {{.name = "turn",
                  .unit = "rad",
                  .scale = 0.005,
                  .lower = -0.2,
                  .upper = 0.2,
                  .meaning = {.label = "turn",
                              .factor = kDegrees,
                              .unit = "deg",
                              .is = "turn that follows a stop, uncounted; negative: back",
                              .said = "the robot turns [on|back] by {} after a stop, uncounted"}},
                 {.name = "way",
                  .unit = "m",
                  .scale = 0.005,
                  .lower = -0.1,
                  .upper = 0.1,
                  .meaning = {.label = "way",
                              .factor = 1e3,
                              .unit = "mm",
                              .is = "way that follows a stop, uncounted; negative: back",
                              .said = "the robot rolls [on|back] by {} after a stop, uncounted"}},
                 {.name = "lasting",
                  .unit = "1",
                  .scale = 1e9,
                  .lower = 0.0,
                  .upper = 1.0,
                  .start = lasting ? 1.0 : 0.0,
                  .fixed = true,
                  .meaning = {.label = "until another turn (1) or stop (0)",
                              .is = "1: a turn stays wound up until another one; 0: until the next stop"}},
                 {.name = "speed",
                  .unit = "m/s",
                  .scale = 1e9,
                  .lower = 0.0,
                  .upper = 10.0,
                  .start = speed,
                  .fixed = true,
                  .meaning = {.label = "at a speed of",
                              .unit = "m/s",
                              .is = "speed before the stop at which these sizes hold; 0: at any"}}},
            .aliases = {"backlash", "time_offset"},
            .separating_motion =
                "many stops, after straights and after turns on the spot, beside reversals without one",
            .manoeuvre = "reversals",
            .dependences = {{vehicle::Covariate::since_stop, vehicle::Channel::both_travel},
                            {vehicle::Covariate::since_stop, vehicle::Channel::yaw_path}},
            .covariates = {vehicle::CovariateGroup::stops, vehicle::CovariateGroup::winding}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const bool lasting : {false, true})
      for (const double speed : {0.0, kSpeed}) all.push_back(std::make_shared<StopSettling>(lasting, speed));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const vehicle::ReleasedWinding& unwound = c.unwound[plain(p[2]) > 0.5 ? 1 : 0];
    const double speed = plain(p[3]);
    const double growth = speed > 0.0 ? c.fastest / speed : 1.0;
    const T way = p[1] * (growth * unwound.way);
    step.left += way;
    step.right += way;
    step.yaw += p[0] * (growth * unwound.turn);
  }

 private:
  static constexpr double kSpeed = 0.3;
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_stop_settling() {
  return std::make_shared<StopSettling>(false, 0.0);
}

}  // namespace odomcalib::calib::terms
