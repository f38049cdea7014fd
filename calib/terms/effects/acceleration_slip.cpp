#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// A rubber contact transmits force only with slip, and slip grows with the force: dL' = dL (1 - k sgn(u_L)
// du_L/dt). Where something holds the robot back or pushes it on, and where only the motor or only the brake
// is strong, the slip of one of the two is all there is (side 1 driving, -1 braking, 0 both alike).
class AccelerationSlip final : public StepEffect<AccelerationSlip> {
 public:
  explicit AccelerationSlip(double side) : StepEffect(row(side)) {}

  static vehicle::EffectRow row(double side) {
    return {.name = "acceleration_slip",
            .parameters = {{.name = "k",
                            .unit = "s^2/m",
                            .scale = 0.01,
                            .lower = -0.2,
                            .upper = 0.2,
                            .meaning = {.factor = 100.0,
                                        .unit = "% at 1 m/s^2",
                                        .is = "share of its way that a wheel slips per m/s^2 of acceleration",
                                        .said = "wheels [slip|run ahead] by {} of acceleration"}},
                           {.name = "side",
                            .unit = "1",
                            .scale = 1e9,
                            .lower = -1.0,
                            .upper = 1.0,
                            .start = side,
                            .fixed = true,
                            .meaning = {.label = "when driving (1), braking (-1) or both (0)",
                                        .is = "1: when it drives; -1: when it brakes; 0: both"}}},
            .aliases = {"time_offset", "encoder_lag"},
            .separating_motion = "equal accelerations at low and at high speed",
            .manoeuvre = "accelerations",
            .dependences = {{vehicle::Covariate::left_acceleration, vehicle::Channel::left_path},
                            {vehicle::Covariate::right_acceleration, vehicle::Channel::right_path},
                            {vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel},
                            {vehicle::Covariate::right_acceleration, vehicle::Channel::right_travel}}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double side : {0.0, -1.0, 1.0}) all.push_back(std::make_shared<AccelerationSlip>(side));
    return all;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.left *= 1.0 - p[0] * growth_of_side(c.left_acceleration, c.left_speed, plain(p[1]));
    step.right *= 1.0 - p[0] * growth_of_side(c.right_acceleration, c.right_speed, plain(p[1]));
  }

 private:
  /// Growth of the speed magnitude, m/s^2; of the other side zero.
  static double growth_of_side(double acceleration, double speed, double side) {
    const double growth = vehicle::growth_of_speed_magnitude(acceleration, speed);
    return growth * side < 0.0 ? 0.0 : growth;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_acceleration_slip() {
  return std::make_shared<AccelerationSlip>(0.0);
}

}  // namespace odomcalib::calib::terms
