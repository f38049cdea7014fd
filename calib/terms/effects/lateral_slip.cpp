#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// The contacts yield sideways under centripetal force: viscous, dy = -k omega ds, and as tyres do at a slip
// angle, dy = -k_tyre |v| omega ds; both may lag by the way over which a tyre takes up its slip angle.
class LateralSlip final : public StepEffect<LateralSlip> {
 public:
  explicit LateralSlip(double relaxation) : StepEffect(row(relaxation)) {}

  static vehicle::EffectRow row(double relaxation) {
    return {.name = "lateral_slip",
            .parameters =
                {{.name = "k",
                  .unit = "s",
                  .scale = 0.01,
                  .lower = -0.2,
                  .upper = 0.2,
                  .meaning = {.label = "by turn rate",
                              .factor = 1e3,
                              .unit = "mm a metre at 1 rad/s",
                              .is = "way outwards in a bend, per metre driven and rad/s of turn rate",
                              .said = "the robot slips [outwards|inwards] in bends, {}"}},
                 {.name = "k_tyre",
                  .unit = "s^2/m",
                  .scale = 0.01,
                  .lower = -0.5,
                  .upper = 0.5,
                  .meaning =
                      {.label = "by acceleration",
                       .factor = 1e3,
                       .unit = "mm a metre at 1 m/s^2",
                       .is = "way outwards in a bend, per metre driven and m/s^2 of centripetal acceleration",
                       .said = "the robot slips [outwards|inwards] in bends, {}"}},
                 {.name = "relaxation",
                  .unit = "m",
                  .scale = 1e9,
                  .lower = 0.0,
                  .upper = 1.0,
                  .start = relaxation,
                  .fixed = true,
                  .meaning = {.label = "taken up over",
                              .factor = 1e3,
                              .unit = "mm",
                              .is = "way over which the tyres take that up; 0: at once"}}},
            .aliases = {"toe", "icr_offset"},
            .separating_motion = "arcs left and right, forward and backward, at two speeds and two radii",
            .manoeuvre = "arcs",
            .dependences = {{vehicle::Covariate::lateral_acceleration, vehicle::Channel::sideways_path},
                            {vehicle::Covariate::lateral_acceleration, vehicle::Channel::sideways},
                            {vehicle::Covariate::turn_rate, vehicle::Channel::sideways}},
            .covariates = {vehicle::CovariateGroup::tyre_relaxation}};
  }

  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all = {std::make_shared<LateralSlip>(0.0)};
    for (const double way : vehicle::kRelaxations) all.push_back(std::make_shared<LateralSlip>(way));
    return all;
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
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_lateral_slip() { return std::make_shared<LateralSlip>(0.0); }

}  // namespace odomcalib::calib::terms
