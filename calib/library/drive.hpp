// A running drive with a calibration, behind the C interface: samples that are checked, odometry and what it
// is uncertain by.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/library/counts.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::library {

struct EffectUse {
  std::string name, unit;
  double value = 0.0;
  int place = 0;  ///< ODOMCALIB_IN_POSE ...
  std::string why;
};

class Drive {
 public:
  /// @param calibration with counts a turn, lengths above zero and finite values
  /// @param counter_bits 0: counts do not wrap
  Drive(const Calibration& calibration, int counter_bits);

  // Return a status of odomcalib/odometry.h.
  int update_counts(double stamp, const Counts& counts);
  int update_angles(double stamp, const std::array<double, 2>& angles);
  int update_speeds(double stamp, const std::array<double, 2>& speeds);
  int restart();
  int set_pose(const math::Pose& pose);

  [[nodiscard]] double stamp() const { return stamp_; }
  [[nodiscard]] math::Pose pose() const;
  /// Mean over the last interval; zero before the first.
  [[nodiscard]] math::Pose velocity() const;
  [[nodiscard]] Eigen::Matrix3d covariance() const;
  [[nodiscard]] Eigen::Matrix3d velocity_covariance() const;
  /// Whether the file states the noise of the contacts and the covariance of the parameters.
  [[nodiscard]] bool covariance_is_whole() const { return covariance_is_whole_; }

  [[nodiscard]] const Calibration& calibration() const { return calibration_; }
  [[nodiscard]] double metres_per_count() const;
  [[nodiscard]] double clock_offset() const { return clock_offset_; }
  /// Displacement of the reported end of a beam from the one that was seen, along the ray and across.
  [[nodiscard]] terms::BeamShift shift(const terms::Sighting& sighting) const;
  [[nodiscard]] const std::vector<EffectUse>& effects() const { return effects_; }
  [[nodiscard]] const char* problem() const { return problem_.data(); }

 private:
  int begin(Motion motion);
  int take(double stamp, const Counts& counts);
  int add(const TickSample& sample);
  int not_a_number(double stamp);
  int rejected(Admission why, const TickSample& sample);
  void list_effects();
  [[nodiscard]] const odometry::Uncertainty& uncertainty() const {
    return odometry_.knows_time() ? uncertainty_of_time_ : usual_uncertainty_;
  }

  Calibration calibration_;
  odometry::Odometry odometry_;
  odometry::Uncertainty usual_uncertainty_, uncertainty_of_time_;  ///< as in Odometry
  bool covariance_is_whole_ = false;
  Motion motion_ = Motion::none;
  CounterWrap wrap_;
  AngleCounts angles_;
  SpeedCounts speeds_;
  SampleGate gate_;
  std::int32_t segment_ = 0;
  double stamp_ = 0.0;
  bool stamp_is_set_ = false;
  math::Pose origin_;  ///< of dead reckoning, in the frame of the poses
  double clock_offset_ = 0.0;
  std::vector<terms::LidarFinding> lidar_;
  std::vector<EffectUse> effects_;
  std::array<char, 240> problem_{};
};

}  // namespace odomcalib::calib::library
