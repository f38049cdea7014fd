#include "calib/terms/effects/factories.hpp"
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
  explicit WheelEccentricity(Side side) : side_(side) {}
  [[nodiscard]] std::string name() const override { return "wheel_eccentricity"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    const std::string wheel = side_ == Side::left ? "left" : "right";
    return {{wheel + "_cos", "1", 5e-3, -0.1, 0.1}, {wheel + "_sin", "1", 5e-3, -0.1, 0.1}};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "slow straight lines of five or more wheel turns";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "slow_straights"; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    if (side_ == Side::left) return {{vehicle::Covariate::left_phase, vehicle::Channel::left_travel}};
    return {{vehicle::Covariate::right_phase, vehicle::Channel::right_travel}};
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
