// Whether two calibrations, or several, are of one robot in one state, and what changed.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/comparison/state.hpp"

namespace odomcalib::calib::comparison {

/// Change of one parameter, from an earlier calibration to a later one; SI units.
struct Change {
  std::string name, unit;
  double before = 0.0, after = 0.0;
  double std = 0.0;      ///< of the difference
  double p_value = 1.0;  ///< that so large a difference is chance, among all that were looked at (S. Holm,
                         ///< Scand. J. Statist. 6, 1979); of an effect: if the true one does not matter

  [[nodiscard]] double difference() const { return after - before; }
  [[nodiscard]] double deviations() const { return std > 0.0 ? difference() / std : 0.0; }
  [[nodiscard]] bool is_change() const;
};

/// Joint test of "nothing changed" with the covariances.
struct JointTest {
  double statistic = 0.0;   ///< chi-squared if nothing changed
  std::size_t freedom = 0;  ///< its degrees of freedom
  double p_value = 1.0;
  [[nodiscard]] bool is_change() const;
  /// No value is in both with a deviation.
  [[nodiscard]] bool is_empty() const { return freedom == 0; }
};

/// Value of an effect. The direction of a vector (cosine and sine part, x and y) depends on where a drive
/// began: its components are one value then, their length, as in "wheel_eccentricity: left_size".
struct EffectValue {
  std::string name;  ///< "effect: parameter"
  Quantity quantity;
  std::vector<std::string> shown_by = {};  ///< parameters whose smallest detectable size holds for it
  double negligible = 0.0;                 ///< differences that do not matter to odometry
};

/// In the order of the file, finite ones only.
std::vector<EffectValue> effect_values(const EffectResult& effect);

/// An effect that one of two calibrations has. It comes and goes by chance near the size from which it is
/// found, and because of what was driven: both are ruled out where the drives of the other calibration would
/// have shown so large a value.
struct LoneEffect {
  std::string name;
  EffectValue value = {};  ///< the one that shows best that it is no chance; without a name: none
  std::optional<double> smallest = {};  ///< that would have been found in the other; none: nobody can tell
  double p_value = 1.0;                 ///< of chance, among all that was looked at of effects (Holm)
  [[nodiscard]] bool is_change() const;
};

struct Difference {
  std::vector<Change> parameters;
  JointTest joint;
  Metre metre = Metre::unstated;
  std::vector<LoneEffect> came, went;
  std::vector<Change> effects;  ///< values of the effects that are in both: "effect: parameter"
  bool has_effects = false;     ///< or curves, one of the two at least
  /// Excess in the readings of odometry with the earlier values, if the later ones are true: m in a metre
  /// straight, rad in a full turn. None where a length was not estimated.
  std::optional<Estimate> metre_error, turn_error;
  /// The joint test, a single parameter or an effect says so.
  [[nodiscard]] bool is_change() const;
  /// A value of an effect, or one that came or went by more than chance.
  [[nodiscard]] bool has_changed_effect() const;
};

/// The two are independent: of different recordings.
Difference difference(const Calibration& before, const Calibration& after);

/// Whether all of them have one state: Cochran's Q (Biometrics 10, 1954), chi-squared with as many degrees of
/// freedom as there are parameters, times the calibrations less one.
JointTest homogeneity(std::span<const Calibration* const> calibrations);

/// The most urgent first.
enum class Urgency {
  refused,   ///< the newest calibration was refused: nobody knows
  changed,   ///< it differs from the one before by more than chance
  warnings,  ///< it was accepted with warnings
  none
};

/// As texts and JSON have it.
const char* name_of(Urgency urgency);

/// Standing of one robot.
struct RobotStanding {
  Urgency urgency = Urgency::none;
  std::optional<Difference> since_last;  ///< between the newest two that were not refused
  double size = 0.0;  ///< of what odometry with the values before would read too much, over what is driven:
                      ///< the larger of the share of a metre and that of a turn; 0 with nothing to compare

  /// Larger sizes first where both are alike.
  [[nodiscard]] bool is_before(const RobotStanding& other) const;
};

/// @param newest of one robot
/// @param usable those of its calibrations that can be compared, in order of time
RobotStanding standing_of(const Calibration& newest, std::span<const Calibration* const> usable);

}  // namespace odomcalib::calib::comparison
