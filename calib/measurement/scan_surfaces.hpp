// The scans of a recording as de-skewed surfaces, with odometry's opinion on how they lie to each other.
#pragma once

#include <vector>

#include "calib/matching/surface.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

/// How the sensor moves while its beam goes round: motion by odometry from the middle of the sweep, linear
/// between poses every few milliseconds.
/// @param mount of the sensor on the base
/// @return motion that refers to neither argument; none when the recording lacks the beams' times
matching::BeamMotion motion_in_sweep(const vehicle::Trajectory& trajectory, const math::Pose& mount,
                                     const Scan& scan);

class ScanSurfaces {
 public:
  /// All arguments but the parameters must outlive this.
  /// @param range_noise standard deviation of a range, m
  ScanSurfaces(const Recording& recording, const vehicle::DriveModel& model,
               std::span<const double> parameters, const vehicle::EffectList& effects, double range_noise);

  /// Reference time of each scan, s.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// Pose of the base by odometry at those times.
  [[nodiscard]] const std::vector<math::Pose>& odometry() const { return odometry_; }
  [[nodiscard]] double range_noise() const { return range_noise_; }

  [[nodiscard]] matching::Surface surface(std::size_t scan) const;
  /// Motion of the sensor from one scan to another by odometry.
  [[nodiscard]] math::Pose guess(std::size_t from, std::size_t to) const;
  /// Why the motion between two scans cannot be compared with the wheels; null when it can.
  [[nodiscard]] const char* gap_between(std::size_t from, std::size_t to) const;

 private:
  const Recording& recording_;
  const vehicle::DriveModel& model_;
  math::Pose mount_;
  double range_noise_;
  vehicle::Trajectory trajectory_;
  std::vector<double> times_;
  std::vector<math::Pose> odometry_;
};

std::vector<math::Pose> poses_at(const vehicle::Trajectory& odometry, const std::vector<double>& times);

}  // namespace odomcalib::calib::measurement
