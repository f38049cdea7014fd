#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// Warm tyres grow and a leaking one shrinks: both diameters change linearly with time (common), and the
// wheels against each other (differential), each per 100 s.
class DriftWithTime final : public StepEffect<DriftWithTime> {
 public:
  [[nodiscard]] std::string name() const override { return "drift_with_time"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"common", "1/(100 s)", 1e-3, -0.05, 0.05}, {"differential", "1/(100 s)", 1e-3, -0.05, 0.05}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "the same manoeuvres at the beginning, in the middle and at the end of the run";
  }
  [[nodiscard]] Storage storage() const override { return Storage::nowhere; }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    const double hundreds = c.t / 100.0;
    step.left *= 1.0 + hundreds * (p[0] - p[1]);
    step.right *= 1.0 + hundreds * (p[0] + p[1]);
  }
};

}  // namespace

std::shared_ptr<const Effect> make_drift_with_time() { return std::make_shared<DriftWithTime>(); }

}  // namespace odomcalib::calib
