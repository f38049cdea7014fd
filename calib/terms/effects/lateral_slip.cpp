#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// The contacts yield sideways under centripetal force: viscous, dy = -k omega ds, and as tyres do at a slip
// angle, dy = -k_tyre |v| omega ds; both may lag by the way over which a tyre takes up its slip angle.
class LateralSlip final : public StepEffect<LateralSlip> {
 public:
  explicit LateralSlip(double relaxation) : relaxation_(relaxation) {}
  [[nodiscard]] std::string name() const override { return "lateral_slip"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"k", "s", 0.01, -0.2, 0.2},
            {"k_tyre", "s^2/m", 0.01, -0.5, 0.5},
            {"relaxation", "m", 1e9, 0.0, 1.0, relaxation_, 0.0, true}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"toe", "icr_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "arcs left and right, forward and backward, at two speeds and two radii";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "arcs"; }
  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all = {std::make_shared<LateralSlip>(0.0)};
    for (const double way : vehicle::kRelaxations) all.push_back(std::make_shared<LateralSlip>(way));
    return all;
  }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::lateral_acceleration, vehicle::Channel::sideways_path},
            {vehicle::Covariate::lateral_acceleration, vehicle::Channel::sideways},
            {vehicle::Covariate::turn_rate, vehicle::Channel::sideways}};
  }

  [[nodiscard]] vehicle::CovariateGroups covariates() const override {
    return {vehicle::CovariateGroup::tyre_relaxation};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double relaxation = plain(p[2]);
    if (relaxation < 0.5 * vehicle::kRelaxations.front()) {
      step.side -= (p[0] + p[1] * std::abs(c.speed)) * c.turn_rate * c.speed * c.dt;
      return;
    }
    const std::size_t k = vehicle::nearest_of(vehicle::kRelaxations, relaxation);
    step.side -= (p[0] * c.relaxed_turn_rate[k] + p[1] * c.relaxed_lateral_acceleration[k]) * c.way;
  }

 private:
  double relaxation_;
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_lateral_slip() { return std::make_shared<LateralSlip>(0.0); }

}  // namespace odomcalib::calib::terms
