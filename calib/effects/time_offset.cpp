#include "calib/effects/factories.hpp"

namespace odomcalib::calib {
namespace {

class TimeOffset final : public Effect {
 public:
  [[nodiscard]] std::string name() const override { return "time_offset"; }
  [[nodiscard]] std::vector<EffectParameter> parameters() const override {
    return {{"offset", "s", 0.02, -1.0, 1.0}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override {
    return {"encoder_lag", "acceleration_slip"};
  }
  [[nodiscard]] std::vector<std::string> always_alike() const override { return {"encoder_lag"}; }
  [[nodiscard]] std::string separating_motion() const override {
    return "equal accelerations at low and at high speed, forward and backward; a filter in the encoder path "
           "cannot be told "
           "apart from a late scan";
  }
  [[nodiscard]] Storage storage() const override { return Storage::driver; }
  [[nodiscard]] double delay(double /*time*/, std::span<const double> parameters) const override {
    return parameters[0];
  }
  [[nodiscard]] Jet delay(double /*time*/, std::span<const Jet> parameters) const override {
    return parameters[0];
  }
};

}  // namespace

std::shared_ptr<const Effect> make_time_offset() { return std::make_shared<TimeOffset>(); }

}  // namespace odomcalib::calib
