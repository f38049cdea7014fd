#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// The head needs T_s for a turn. If the sweep is not de-skewed, or with wrong beam times, a feature is met
// again after a shortened or lengthened time: d(yaw) = -c omega^2 dt with c = T_s / 2 pi, the same sign for
// left and right turns.
class ScanSkew final : public StepEffect<ScanSkew> {
 public:
  [[nodiscard]] std::string name() const override { return "scan_skew"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"c", "s", 5e-3, -0.1, 0.1}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"turn_direction_asymmetry", "direction_dependent_diameter"};
  }
  [[nodiscard]] std::string separating_motion() const override {
    return "turns left and right at two or more rates of at least 1:3, and single-wheel turns";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "turns"; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::turn_rate, vehicle::Channel::track}};
  }
  [[nodiscard]] bool bends_scans() const override { return true; }
  /// Scans whose beams were sent at other times than stated are bent by turning, and matches of them find
  /// other ways the faster the robot drives and turns: what looks like a term of turning is no more the
  /// wheels'.
  [[nodiscard]] bool excludes(const vehicle::Dependence& dependence) const override {
    return dependence.covariate == vehicle::Covariate::lateral_acceleration ||
           dependence.covariate == vehicle::Covariate::turn_rate;
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.yaw -= p[0] * c.turn_rate * c.turn_rate * c.dt;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_scan_skew() { return std::make_shared<ScanSkew>(); }

}  // namespace odomcalib::calib::terms
