#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Rolling slip under gravity: downhill creep ds = -|ds| (k_x cos(heading) + k_y sin(heading)).
// A property of the place: reported, never written back.
class FloorSlope final : public StepEffect<FloorSlope> {
 public:
  [[nodiscard]] std::string name() const override { return "floor_slope"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"kappa_x", "1", 0.015, -0.1, 0.1}, {"kappa_y", "1", 0.015, -0.1, 0.1}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"carpet"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "straight lines on four headings, forward and backward on each";
  }
  [[nodiscard]] std::string manoeuvre() const override { return "headings"; }
  [[nodiscard]] vehicle::Storage storage() const override { return vehicle::Storage::nowhere; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::heading, vehicle::Channel::both_path}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double path = std::abs(c.speed) * c.dt;
    const T creep = -path * (p[0] * c.heading_cosine + p[1] * c.heading_sine);
    step.left += creep;
    step.right += creep;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_floor_slope() { return std::make_shared<FloorSlope>(); }

}  // namespace odomcalib::calib::terms
