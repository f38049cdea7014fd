// The part of a calibration that dead reckoning applies, and where the rest of it belongs.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/vehicle/drive_model.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::odometry {

/// Where a value of an effect takes effect: in odometry; in what the reference is compared with, and not in
/// odometry; or nowhere, because it belongs to the place or the day.
enum class Place { odometry, reference, nowhere };

struct Placement {
  std::string effect;     ///< as in the calibration file, or "smooth term of ... on ..."
  std::string parameter;  ///< empty for a smooth term
  Quantity quantity;
  Place place = Place::odometry;
};
/// Every value of every effect and smooth term of the calibration, in the order of the file.
std::vector<Placement> effect_placements(const Calibration& calibration);

/// Names of effects in the file that this program cannot compensate, because it does not know them or not
/// with these parameters: odometry goes on without them.
std::vector<std::string> unknown_effects(const Calibration& calibration);

/// A calibration that holds the nominal values and no effects: dead reckoning as the robot does it now.
Calibration nominal_calibration(const RobotDescription& robot);

/// Wheels that warm up or leak change with the time since the calibration's own drive began. A drive that
/// begins on the same clock, during that one or no longer after its end than it took, finds the wheels as
/// they were at that moment, and later as they were at the end: how they went on nobody measured. When any
/// other drive begins, nobody knows how warm they are: they count by the middle of the calibration's drive.
class DriveClock {
 public:
  explicit DriveClock(const Calibration& calibration);
  /// @param stamp of the first ticks of the drive, s
  DriveClock(const Calibration& calibration, double stamp) : DriveClock(calibration) { start(stamp); }
  void start(double stamp);
  [[nodiscard]] bool is_known() const { return begin_.has_value(); }
  /// @return s since the beginning of the calibration's drive, from zero to its duration
  [[nodiscard]] double at(double stamp) const;

 private:
  double duration_ = 0.0;
  std::optional<double> calibrated_;  ///< begin of the calibration's drive, by its clock
  std::optional<double> begin_;       ///< the same, where that clock is also the one of this drive
};

/// Parameters of the base, then of each effect that acts on odometry.
struct Correction {
  Eigen::VectorXd parameters;
  vehicle::EffectList effects;
  /// Covariance of the parameters, as far as the file has it: that of the base, and beside it the deviation
  /// of each parameter of a named effect for itself; zero for what the file states without.
  Eigen::MatrixXd covariance;
};
/// A smooth term of time is about its mean: where the time is not known, nothing is better known than that.
Correction correction_of(const Calibration& calibration, bool time_is_known);

}  // namespace odomcalib::calib::odometry
