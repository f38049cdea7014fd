#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// The head needs T_s for a turn. If the sweep is not de-skewed, or with wrong beam times, a feature is met
// again after a shortened or lengthened time: d(yaw) = -c omega^2 dt with c = T_s / 2 pi, the same sign for
// left and right turns.
class ScanSkew final : public StepEffect<ScanSkew> {
 public:
  ScanSkew() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "scan_skew",
            .parameters = {{.name = "c",
                            .unit = "s",
                            .scale = 5e-3,
                            .lower = -0.1,
                            .upper = 0.1,
                            .meaning = {.factor = 100.0,
                                        .unit = "% at 1 rad/s",
                                        .is = "share of left turns that the sweeps do not see, and of right "
                                              "turns that they see twice, per rad/s",
                                        .said = "sweeps of the lidar see {} too [little|much] of left turns "
                                                "and as much too [much|little] of right ones"}}},
            .aliases = {"turn_direction_asymmetry", "direction_dependent_diameter"},
            .separating_motion =
                "turns left and right at two or more rates of at least 1:3, and single-wheel turns",
            .manoeuvre = "turns",
            .dependences = {{vehicle::Covariate::turn_rate, vehicle::Channel::track}},
            // Scans whose beams were sent at other times than stated are bent by turning, and matches of them
            // find other ways the faster the robot drives and turns: what looks like a term of turning is no
            // more the wheels'.
            .excluded_covariates = {vehicle::Covariate::lateral_acceleration, vehicle::Covariate::turn_rate},
            .bends_scans = true};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.yaw -= p[0] * c.turn_rate * c.turn_rate * c.dt;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_scan_skew() { return std::make_shared<ScanSkew>(); }

}  // namespace odomcalib::calib::terms
