// Dead reckoning from ticks with a calibration and its host-side effects.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/measurements.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::odometry {

/// Base pose at each tick sample, starting at the origin. Frame: base at the first sample. What changed with
/// time is followed where the stamps are on the clock of the calibration's own drive (DriveClock in
/// predict.cpp).
std::vector<PoseSample> predict(const Recording& recording, const Calibration& calibration);

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

/// The same, sample by sample, for the running daemon.
class Odometry {
 public:
  explicit Odometry(const Calibration& calibration);
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;
  /// Adds one sample and returns the base pose at its time. The first sample defines the origin; a new
  /// segment continues from the last pose without motion in between.
  PoseSample update(const TickSample& sample);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Standard deviations of an increment one metre long, forward and sideways in m, in heading in rad:
/// variances grow with the way that the wheels roll, so that those of a longer one grow with its root.
using IncrementNoise = std::array<double, 3>;

/// How far dead reckoning may be off after a path, when nothing but chance disturbs the wheels: standard
/// deviations x, y in the frame of the first pose and yaw of the last one: m, m, rad. First order in
/// the errors, increments independent of each other.
/// @param track_width m: wheels roll in turns on the spot, too
std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width);

}  // namespace odomcalib::calib::odometry
