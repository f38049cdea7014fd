#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Lidar and encoders keep time by crystals of their own, or a time axis is made of a nominal cycle count:
/// the delay grows linearly, delta(t) = rate (t - middle of the recording). Centred, so that it is not
/// mistaken for a constant offset.
class ClockDrift final : public vehicle::Effect {
 public:
  ClockDrift() : Effect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "clock_drift",
            .parameters = {{.name = "rate",
                            .unit = "s/s",
                            .scale = 1e-4,
                            .lower = -0.1,
                            .upper = 0.1,
                            .meaning = {.factor = 1e6,
                                        .unit = "ms in 1000 s",
                                        .is = "by which the two clocks drift apart",
                                        .said = "the clocks of scans and counts drift apart by {}"}}},
            .aliases = {"time_offset"},
            .separating_motion = "five minutes or more with accelerations spread over the whole run",
            .storage = vehicle::Storage::driver,
            .clock_part = vehicle::ClockPart::rate};
  }

  [[nodiscard]] double delay(double time, std::span<const double> p) const override { return p[0] * time; }
  [[nodiscard]] vehicle::Jet delay(double time, std::span<const vehicle::Jet> p) const override {
    return p[0] * time;
  }
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_clock_drift() { return std::make_shared<ClockDrift>(); }

}  // namespace odomcalib::calib::terms
