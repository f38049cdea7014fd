#include "calib/terms/effects/factories.hpp"
#include "calib/terms/effects/step_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Fibres lean: each metre of travel shifts the robot in a direction fixed in the room, (p_x, p_y) |ds|.
// A property of the place: reported, never written back.
class Carpet final : public StepEffect<Carpet> {
 public:
  [[nodiscard]] std::string name() const override { return "carpet"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"p_x", "1", 0.015, -0.2, 0.2}, {"p_y", "1", 0.015, -0.2, 0.2}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"floor_slope"}; }
  [[nodiscard]] std::string separating_motion() const override { return "straight lines on four headings"; }
  [[nodiscard]] std::string manoeuvre() const override { return "headings"; }
  [[nodiscard]] vehicle::Storage storage() const override { return vehicle::Storage::nowhere; }
  [[nodiscard]] std::vector<vehicle::Dependence> dependences() const override {
    return {{vehicle::Covariate::heading, vehicle::Channel::both_path},
            {vehicle::Covariate::heading, vehicle::Channel::sideways_path}};
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    const double path = std::abs(c.speed) * c.dt;
    const double cosine = c.heading_cosine, sine = c.heading_sine;
    const T along = path * (p[0] * cosine + p[1] * sine);
    step.left += along;
    step.right += along;
    step.side += path * (p[1] * cosine - p[0] * sine);
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_carpet() { return std::make_shared<Carpet>(); }

}  // namespace odomcalib::calib::terms
