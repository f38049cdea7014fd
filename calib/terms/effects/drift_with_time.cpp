#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Warm tyres grow and a leaking one shrinks: both diameters change with time (common), and the wheels against
// each other (differential), as 1 - exp(-t / time constant), scaled to one after 100 s; a long time constant
// makes it linear.
class DriftWithTime final : public StepEffect<DriftWithTime> {
 public:
  explicit DriftWithTime(double time_constant) : time_constant_(time_constant) {}
  [[nodiscard]] std::string name() const override { return "drift_with_time"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"common", "1/(100 s)", 1e-3, -0.2, 0.2},
            {"differential", "1/(100 s)", 1e-3, -0.2, 0.2},
            {"time_constant", "s", 1e9, 1.0, 1e6, time_constant_, 0.0, true}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "the same manoeuvres at the beginning, in the middle and at the end of the run";
  }
  [[nodiscard]] vehicle::Storage storage() const override { return vehicle::Storage::nowhere; }
  [[nodiscard]] bool carries_over() const override { return true; }
  [[nodiscard]] std::vector<std::shared_ptr<const vehicle::Effect>> variants() const override {
    std::vector<std::shared_ptr<const vehicle::Effect>> all;
    for (const double time_constant : {1e5, 120.0, 40.0})
      all.push_back(std::make_shared<DriftWithTime>(time_constant));
    return all;
  }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::time, vehicle::Channel::left_travel},
            {vehicle::Covariate::time, vehicle::Channel::right_travel},
            {vehicle::Covariate::time, vehicle::Channel::both_travel}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    using std::exp;
    const T hundreds = (1.0 - exp(-c.t / p[2])) / (1.0 - exp(-100.0 / p[2]));
    step.left *= 1.0 + hundreds * (p[0] - p[1]);
    step.right *= 1.0 + hundreds * (p[0] + p[1]);
  }

 private:
  double time_constant_;
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_drift_with_time() { return std::make_shared<DriftWithTime>(1e5); }

}  // namespace odomcalib::calib::terms
