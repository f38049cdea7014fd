// One effect, something that can be missing in the plain differential-drive model: a row of data, and the
// functions that act.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/vehicle/channel.hpp"
#include "calib/vehicle/covariates.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/vehicle/parameter_meaning.hpp"

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
  ParameterMeaning meaning = {};  ///< that of a smooth term's coefficient is empty
  /// Shapes (thresholds, lengths) start away from zero; sizes start at zero.
  [[nodiscard]] bool is_size() const { return start == 0.0 && !fixed; }
};

/// Where a correction can live.
enum class Storage { controller, host, driver, nowhere };

/// The part that an effect describes of the sensor's clock against that of the encoders.
enum class ClockPart { none, offset, rate };

/// A row of the catalogue: the constant part of an effect, in the effect's own file.
struct EffectRow {
  std::string name;
  std::vector<EffectParameter> parameters;
  /// Combinations of the parameters, in deviations, that a prior expects to be zero beside the parameters'
  /// own: a row each, a factor for each parameter.
  std::vector<std::vector<double>> expected_zeros = {};
  /// Names of the effects that look alike, and the motion that separates them.
  std::vector<std::string> aliases = {};
  /// Names that no motion can separate from this one: listed beside it whenever it is found.
  std::vector<std::string> observationally_equivalent = {};
  std::string separating_motion = {};
  /// The motion that separates them, as a manoeuvre that can be driven in a small area; empty: none.
  std::string manoeuvre = {};
  /// Where its signature lies. A rest that depends on these covariates on these channels is the same effect
  /// with another function than the textbook's.
  std::vector<Dependence> dependences = {};
  /// A free smooth term of one of these covariates, or on one of these channels, would describe the same once
  /// more where this effect was found.
  std::vector<Covariate> excluded_covariates = {};
  std::vector<Channel> excluded_channels = {};
  Storage storage = Storage::host;
  /// Whether it distorts the sweeps of the sensor: a comparison with the reference needs it, dead reckoning
  /// must not have it.
  bool bends_scans = false;
  /// Whether the next drive begins with it as this one ended.
  bool carries_over = false;
  ClockPart clock_part = ClockPart::none;
  /// Whether either of two states may be the undisturbed one: nothing shows which way of turning is the
  /// normal one.
  bool has_two_states = false;
  /// Covariates that apply() uses beside those that every interval has.
  CovariateGroups covariates = {};
};

/// A row, and what acts: a class of its own for each effect has the functions.
class Effect {
 public:
  explicit Effect(EffectRow row) : row_(std::move(row)) {}
  virtual ~Effect() = default;

  /// Members of the row, as long as the effect lives.
  [[nodiscard]] const std::string& name() const { return row_.name; }
  [[nodiscard]] const std::vector<EffectParameter>& parameters() const { return row_.parameters; }
  [[nodiscard]] const std::vector<std::vector<double>>& expected_zeros() const { return row_.expected_zeros; }
  [[nodiscard]] const std::vector<std::string>& aliases() const { return row_.aliases; }
  [[nodiscard]] const std::vector<std::string>& observationally_equivalent() const {
    return row_.observationally_equivalent;
  }
  [[nodiscard]] const std::string& separating_motion() const { return row_.separating_motion; }
  [[nodiscard]] const std::string& manoeuvre() const { return row_.manoeuvre; }
  [[nodiscard]] const std::vector<Dependence>& dependences() const { return row_.dependences; }
  [[nodiscard]] bool excludes(const Dependence& dependence) const {
    const auto contains = [](const auto& list, const auto& one) {
      return std::find(list.begin(), list.end(), one) != list.end();
    };
    return contains(row_.excluded_covariates, dependence.covariate) ||
           contains(row_.excluded_channels, dependence.channel);
  }
  [[nodiscard]] Storage storage() const { return row_.storage; }
  [[nodiscard]] bool bends_scans() const { return row_.bends_scans; }
  [[nodiscard]] bool carries_over() const { return row_.carries_over; }
  [[nodiscard]] ClockPart clock_part() const { return row_.clock_part; }
  [[nodiscard]] bool has_two_states() const { return row_.has_two_states; }
  [[nodiscard]] CovariateGroups covariates() const { return row_.covariates; }

  /// The same effect with other shapes to start from; a search tries them all and keeps the best.
  [[nodiscard]] virtual std::vector<std::shared_ptr<const Effect>> variants() const { return {}; }
  /// Why no mechanism makes these values together, each of them possible; empty when one does.
  [[nodiscard]] virtual std::string contradiction(std::span<const double> parameters) const {
    (void)parameters;
    return {};
  }
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

 private:
  EffectRow row_;
};

using EffectList = std::vector<std::shared_ptr<const Effect>>;

}  // namespace odomcalib::calib::vehicle
