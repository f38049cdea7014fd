#include "calib/effects/factories.hpp"
#include "calib/effects/step_effect.hpp"

namespace odomcalib::calib {
namespace {

// Trailing casters swing through half a turn after a reversal and push the chassis aside: the yaw added after
// the distance s since the reversal falls off as exp(-s / length), with a length of two to four caster
// trails.
class CasterKick final : public StepEffect<CasterKick> {
 public:
  explicit CasterKick(double length) : length_(length) {}
  [[nodiscard]] std::string name() const override { return "caster_kick"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"kappa", "rad", 0.01, -0.2, 0.2}, {"length", "m", 1e9, 0.005, 1.0, length_, true}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"backlash", "time_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "reversals straight after a left and after a right arc, and long straights after a reversal";
  }
  [[nodiscard]] std::vector<std::shared_ptr<const Effect>> variants() const override {
    std::vector<std::shared_ptr<const Effect>> all;
    for (const double length : {0.04, 0.08, 0.15}) all.push_back(std::make_shared<CasterKick>(length));
    return all;
  }
  [[nodiscard]] std::vector<Law> laws() const override {
    return {{Variable::since_reversal, Carrier::yaw_path}};
  }

  template <typename T>
  static void act(const StepContext& c, std::span<const T> p, WheelStep<T>& step) {
    using std::exp;
    step.yaw += p[0] * c.direction * (std::abs(c.speed) * c.dt / p[1]) * exp(-c.since_reversal / p[1]);
  }

 private:
  double length_;
};

}  // namespace

std::shared_ptr<const Effect> make_caster_kick() { return std::make_shared<CasterKick>(0.08); }

}  // namespace odomcalib::calib
