#include "calib/terms/effects/factories.hpp"
#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Lidar and encoders keep time by crystals of their own, or a time axis is made of a nominal cycle count:
/// the delay grows linearly, delta(t) = rate (t - middle of the recording). Centred, so that it is not
/// mistaken for a constant offset.
class ClockDrift final : public vehicle::Effect {
 public:
  [[nodiscard]] std::string name() const override { return "clock_drift"; }
  [[nodiscard]] std::vector<vehicle::EffectParameter> parameters() const override {
    return {{"rate", "s/s", 1e-4, -0.1, 0.1}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"time_offset"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "five minutes or more with accelerations spread over the whole run";
  }
  [[nodiscard]] vehicle::Storage storage() const override { return vehicle::Storage::driver; }
  [[nodiscard]] vehicle::ClockPart clock_part() const override { return vehicle::ClockPart::rate; }
  [[nodiscard]] double delay(double time, std::span<const double> p) const override { return p[0] * time; }
  [[nodiscard]] vehicle::Jet delay(double time, std::span<const vehicle::Jet> p) const override {
    return p[0] * time;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_clock_drift() { return std::make_shared<ClockDrift>(); }

}  // namespace odomcalib::calib::terms
