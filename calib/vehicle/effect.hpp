// Interface of one effect: something that can be missing in the plain differential-drive model.
#pragma once

#include <ceres/jet.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "calib/vehicle/channel.hpp"
#include "calib/vehicle/covariates/covariate_groups.hpp"
#include "calib/vehicle/motion_step.hpp"

namespace odomcalib::calib::vehicle {

/// Scalar for automatic derivatives: the value and its derivatives by up to 16 parameters at a time.
inline constexpr int kJetSize = 16;
using Jet = ceres::Jet<double, kJetSize>;

struct EffectParameter {
  std::string name;
  std::string unit;
  double scale = 1.0;  ///< typical size; steps and tolerances are relative to it
  double lower = 0.0;  ///< physically plausible range
  double upper = 0.0;
  double start =
      0.0;  ///< where a fit begins; not zero for what gives the term its shape, such as a threshold
  double prior =
      0.0;  ///< deviation of a normal prior about zero; 0: none. What the data do not show stays small
  bool fixed = false;  ///< a shape that is tried at several values instead of being fitted
  /// In an effect of the reference: this part belongs to the wheels, whoever looks at them.
  bool of_wheels = false;
  /// Shapes (thresholds, lengths) start away from zero; sizes start at zero.
  [[nodiscard]] bool is_size() const { return start == 0.0 && !fixed; }
};

/// Where a correction can live.
enum class Storage { controller, host, driver, nowhere };

/// The part that an effect describes of the sensor's clock against that of the encoders.
enum class ClockPart { none, offset, rate };

class Effect {
 public:
  virtual ~Effect() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::vector<EffectParameter> parameters() const = 0;
  /// Combinations of the parameters, in deviations, that a prior expects to be zero beside the parameters'
  /// own: a row each, a factor for each parameter.
  [[nodiscard]] virtual std::vector<std::vector<double>> expected_zeros() const { return {}; }
  /// Names of the effects that look alike, and the motion that separates them.
  [[nodiscard]] virtual std::vector<std::string> aliases() const { return {}; }
  /// Names that no motion can separate from this one: listed beside it whenever it is found.
  [[nodiscard]] virtual std::vector<std::string> observationally_equivalent() const { return {}; }
  [[nodiscard]] virtual std::string separating_motion() const { return {}; }
  /// The motion that separates them, as a manoeuvre that can be driven in a small area; empty: none.
  [[nodiscard]] virtual std::string manoeuvre() const { return {}; }
  /// The same effect with other shapes to start from; a search tries them all and keeps the best.
  [[nodiscard]] virtual std::vector<std::shared_ptr<const Effect>> variants() const { return {}; }
  /// Where its signature lies. A rest that depends on these covariates on these channels is the same effect
  /// with another function than the textbook's.
  [[nodiscard]] virtual std::vector<Dependence> dependences() const { return {}; }
  [[nodiscard]] virtual Storage storage() const { return Storage::host; }
  /// Whether it distorts the sweeps of the sensor: a comparison with the reference needs it, dead reckoning
  /// must not have it.
  [[nodiscard]] virtual bool bends_scans() const { return false; }
  /// Whether the next drive begins with it as this one ended.
  [[nodiscard]] virtual bool carries_over() const { return false; }
  [[nodiscard]] virtual ClockPart clock_part() const { return ClockPart::none; }
  /// Whether a free smooth term of that dependence would describe the same once more where this effect was
  /// found.
  [[nodiscard]] virtual bool excludes(const Dependence& dependence) const {
    (void)dependence;
    return false;
  }
  /// Why no mechanism makes these values together, each of them possible; empty when one does.
  [[nodiscard]] virtual std::string contradiction(std::span<const double> parameters) const {
    (void)parameters;
    return {};
  }

  /// Whether either of two states may be the undisturbed one: nothing shows which way of turning is the
  /// normal one.
  [[nodiscard]] virtual bool has_two_states() const { return false; }

  /// Covariates that apply() uses beside those that every interval has.
  [[nodiscard]] virtual CovariateGroups covariates() const { return {}; }
  /// Changes the motion of one tick interval in place. Parameters at their start leave it unchanged.
  virtual void apply(const StepContext& context, std::span<const double> parameters,
                     WheelStep<double>& step) const {
    (void)context, (void)parameters, (void)step;
  }
  virtual void apply(const StepContext& context, std::span<const Jet> parameters,
                     WheelStep<Jet>& step) const {
    (void)context, (void)parameters, (void)step;
  }
  /// Delay in s of the sensor against the encoders: a scan stamped t was taken at encoder time t - delay.
  /// @param time s, counted from the middle of the recording
  [[nodiscard]] virtual double delay(double time, std::span<const double> parameters) const {
    (void)time, (void)parameters;
    return 0.0;
  }
  [[nodiscard]] virtual Jet delay(double time, std::span<const Jet> parameters) const {
    (void)time, (void)parameters;
    return Jet(0.0);
  }
};

using EffectList = std::vector<std::shared_ptr<const Effect>>;

}  // namespace odomcalib::calib::vehicle
