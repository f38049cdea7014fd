// Dead reckoning of a running drive: sample by sample, with what is known up to each.
#pragma once

#include <memory>

#include "calib/odometry/dead_reckoning.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::odometry {

class Odometry {
 public:
  /// Errors: none; of the calibration nothing is checked.
  explicit Odometry(const Calibration& calibration);
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;

  /// Adds one sample and returns the base pose at its time. The first sample defines the origin; a new
  /// segment continues from the last pose without motion in between, and so does a sample that does not
  /// advance in time, which is not taken in. Takes no memory.
  PoseSample update(const TickSample& sample);
  /// The next sample may have any stamp, and its segment has to be a new one: how fast the wheels turned
  /// before it is forgotten.
  void forget_samples();

  /// Whether the next sample that advances in time adds an interval.
  [[nodiscard]] bool has_samples() const;
  /// Whether the drive began on the clock of the calibration's own (DriveClock).
  [[nodiscard]] bool knows_time() const;
  /// The last interval that was added, s; 0: none yet.
  [[nodiscard]] double duration() const;
  [[nodiscard]] const vehicle::StepContext& interval() const;
  [[nodiscard]] const DeadReckoning& reckoning() const;
  /// Takes the last interval's motion back.
  void take_back();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace odomcalib::calib::odometry
