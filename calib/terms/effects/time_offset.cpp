#include "calib/terms/effects/step_effect.hpp"
#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::terms {
namespace {

// A scan stamped t was taken at encoder time t - offset. Late encoders are seldom a pure delay: a first-order
// filter that is late by tau reads phi(t - tau) + tau^2 / 2 phi'' + ..., two half as long in a row add half
// of that. So dL' = dL - smoothing (aL(end) - aL(begin)), and dR' likewise; zero for a pure delay.
class TimeOffset final : public StepEffect<TimeOffset> {
 public:
  TimeOffset() : StepEffect(row()) {}

  static vehicle::EffectRow row() {
    return {.name = "time_offset",
            .parameters =
                {{.name = "offset",
                  .unit = "s",
                  .scale = 0.02,
                  .lower = -1.0,
                  .upper = 1.0,
                  .meaning = {.label = "delay of the scans",
                              .factor = 1e3,
                              .unit = "ms",
                              .is = "by which scans are stamped later than counts of the same moment",
                              .said = "scans are stamped {} [later|earlier] than counts of the same moment"}},
                 {.name = "smoothing",
                  .unit = "s^2",
                  .scale = kTypicalSmoothing,
                  .lower = -0.02,
                  .upper = 0.02,
                  .prior = kTypicalSmoothing,
                  .of_wheels = true,
                  .meaning = {.label = "smoothing of the counts",
                              .factor = 1e6,
                              .unit = "ms^2",
                              .is = "of the counts: half the square of a filter's time constant"}}},
            .aliases = {"encoder_lag", "acceleration_slip"},
            .observationally_equivalent = {"encoder_lag"},
            .separating_motion =
                "equal accelerations at low and at high speed, forward and backward; a filter in the encoder "
                "path cannot be separated apart from a late scan",
            .manoeuvre = "accelerations",
            .storage = vehicle::Storage::driver,
            .clock_part = vehicle::ClockPart::offset,
            .covariates = {vehicle::CovariateGroup::acceleration_changes}};
  }

  /// A delay next to nothing with a smoothing below zero is what noise of coarse counts makes of the wheels.
  [[nodiscard]] std::string contradiction(std::span<const double> p) const override {
    const bool is_late = std::abs(p[0]) >= vehicle::settings::kNegligibleShare * parameters().front().scale;
    return !is_late && p[1] < 0.0 ? "a filter does not sharpen" : "";
  }
  [[nodiscard]] double delay(double /*time*/, std::span<const double> parameters) const override {
    return parameters[0];
  }
  [[nodiscard]] vehicle::Jet delay(double /*time*/, std::span<const vehicle::Jet> parameters) const override {
    return parameters[0];
  }

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    step.left -= p[1] * c.left_acceleration_change;
    step.right -= p[1] * c.right_acceleration_change;
  }

 private:
  static constexpr double kTypicalSmoothing = 1e-3;  ///< a filter that is late by 45 ms
};

}  // namespace

std::shared_ptr<const vehicle::Effect> make_time_offset() { return std::make_shared<TimeOffset>(); }

}  // namespace odomcalib::calib::terms
