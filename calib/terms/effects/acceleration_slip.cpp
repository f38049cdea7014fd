#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// A rubber contact transmits force only with slip, and slip grows with the force: dL' = dL (1 - k sgn(u_L)
// du_L/dt). Where something holds the robot back or pushes it on, and where only the motor or only the brake
// is strong, the slip of one of the two is all there is (side 1 driving, -1 braking, 0 both alike).
class AccelerationSlip final : public StepEffect<AccelerationSlip> {
 public:
  explicit AccelerationSlip(double side) : side_(side) {}
  [[nodiscard]] std::string name() const override { return "acceleration_slip"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"k", "s^2/m", 0.01, -0.2, 0.2}, {"side", "1", 1e9, -1.0, 1.0, side_, 0.0, true}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"time_offset", "encoder_lag"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "equal accelerations at low and at high speed";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "accelerations"; }
  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double side : {0.0, -1.0, 1.0}) all.push_back(std::make_shared<AccelerationSlip>(side));
    return all;
  }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::left_acceleration, vehicle::Channel::left_path},
            {vehicle::Covariate::right_acceleration, vehicle::Channel::right_path},
            {vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel},
            {vehicle::Covariate::right_acceleration, vehicle::Channel::right_travel}};
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

  double side_;
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_acceleration_slip() {
  return std::make_shared<AccelerationSlip>(0.0);
}

}  // namespace odomcalib::calib::terms
