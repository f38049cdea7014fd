// Errors of the readings themselves: where a beam's end is reported, against where it is. Such errors hide in
// the matches as scale or lever arm and show only between scans taken in different directions.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/vehicle/parameter_meaning.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::terms {

/// Quantities that a reading's error may depend on.
struct Sighting {
  double bearing = 0.0;    ///< rad, direction of the beam in the sensor's frame
  double range = 0.0;      ///< m
  double incidence = 0.0;  ///< rad, signed; 0 where it is not needed
};

/// Displacement of a beam's end, measured minus true.
struct BeamShift {
  double radial = 0.0;   ///< m, outwards
  double angular = 0.0;  ///< rad, counter-clockwise
};

struct LidarParameter {
  std::string name;
  std::string unit;
  double negligible = 0.0;  ///< size below which it is not worth a claim
  double largest = 0.0;     ///< no device is worse
  vehicle::ParameterMeaning meaning = {};
};

/// A row of the catalogue: the constant part of an effect of the lidar, in the effect's own file.
struct LidarEffectRow {
  /// Name of the effect; the covariate where it is an unnamed dependence.
  std::string name;
  bool is_named = true;
  /// Whether scans may be corrected by it. What is nearly a common scale no scan shows well enough: it is
  /// reported, and the scans stay as they are.
  bool is_correctable = true;
  /// Whether the map of all scans judges it better than pairs of scans do.
  bool is_judged_in_map = false;
  /// Whether it bends the walls of a map, as ranges that are too short would: it is sought before there is
  /// one.
  bool bends_walls = false;
  /// Share of the squared disagreement between scans that it may leave, at most, to be worth its freedom.
  double may_leave = 0.9965;
  /// How many deviations the mean gain on held-out pairs must lie above zero.
  double least_z = 2.5;
  /// Share of the statistic of a free term of its covariate that it must reach to be taken instead.
  double share_of_free_term = 0.5;
  /// The covariate it depends on. A rest that depends on the same one is the same effect with another
  /// function.
  std::string covariate;
  std::vector<LidarParameter> parameters;
  std::vector<std::string> aliases = {};
};

/// A row, and what acts: a class of its own for each effect has the functions.
class LidarEffect {
 public:
  explicit LidarEffect(LidarEffectRow row) : row_(std::move(row)) {}
  virtual ~LidarEffect() = default;

  /// Members of the row, as long as the effect lives.
  [[nodiscard]] const std::string& name() const { return row_.name; }
  [[nodiscard]] bool is_named() const { return row_.is_named; }
  [[nodiscard]] bool is_correctable() const { return row_.is_correctable; }
  [[nodiscard]] bool is_judged_in_map() const { return row_.is_judged_in_map; }
  [[nodiscard]] bool bends_walls() const { return row_.bends_walls; }
  [[nodiscard]] double may_leave() const { return row_.may_leave; }
  [[nodiscard]] double least_z() const { return row_.least_z; }
  [[nodiscard]] double share_of_free_term() const { return row_.share_of_free_term; }
  [[nodiscard]] const std::string& covariate() const { return row_.covariate; }
  [[nodiscard]] const std::vector<LidarParameter>& parameters() const { return row_.parameters; }
  [[nodiscard]] const std::vector<std::string>& aliases() const { return row_.aliases; }

  /// Shift per unit of each parameter: errors are linear in them to first order.
  [[nodiscard]] virtual std::vector<BeamShift> shifts(const Sighting& sighting) const = 0;
  /// Total shift by the parameters, beyond first order where the physics is known.
  [[nodiscard]] virtual BeamShift total(const Sighting& sighting, std::span<const double> values) const;
  /// Estimates as a user reads them, from parameters and their deviations.
  [[nodiscard]] virtual std::vector<std::pair<std::string, Quantity>> quantities(
      std::span<const double> values, std::span<const double> deviations) const;
  /// The other way round: parameters from what quantities() states, in its order. Fewer than those are
  /// none of this effect: empty.
  [[nodiscard]] virtual std::vector<double> values_of(const QuantityList& stated) const;

 private:
  LidarEffectRow row_;
};

using LidarEffectPtr = std::shared_ptr<const LidarEffect>;

/// An error of the lidar itself that was found in its scans.
struct LidarFinding {
  LidarEffectPtr effect;
  std::vector<double> values, deviations;  ///< in the order of effect->parameters()
  double family_p_value = 1.0;
  double before = 0.0, after = 0.0;  ///< m, RMS distance between scans on pairs that were not fitted
};

/// Whether a finding is the rest of another's function and no finding of its own.
bool completes(const LidarFinding& finding, const std::vector<LidarFinding>& all);

/// The scan as it would be without the errors found.
Scan corrected(const Scan& scan, const std::vector<LidarFinding>& findings);

}  // namespace odomcalib::calib::terms
