// Wheel rotation as a function of time, from tick samples or tuple files.
#pragma once

#include <cstddef>
#include <vector>

#include "calib/wheels/wheel_motion.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::wheels {

/// How the motion of the intervals before and after enters that within an interval: see WheelTrack::bend.
struct Bend {
  double before = 0.0;
  double after = 0.0;
};

/// Cumulative wheel angles in rad at strictly increasing times.
struct WheelTrack {
  std::vector<double> t;
  std::vector<double> left;
  std::vector<double> right;
  std::vector<int> segment;  ///< motion is unknown across a change of segment
  double tick_period = 0.0;  ///< s, median, of ticks that were sampled more finely; 0: they were not
  double tick_angle = 0.0;   ///< rad, of one count

  [[nodiscard]] bool empty() const { return t.size() < 2; }
  /// Index k with t[k] <= time < t[k+1], clamped to the valid intervals.
  [[nodiscard]] std::size_t interval_at(double time) const;
  /// True when [from, to] lies inside the samples and no segment changes in it.
  [[nodiscard]] bool covers(double from, double to) const;
  /// Between samples the wheels speed up as steadily as from the interval before to the one after: of the
  /// motion w they make s w + s (s - 1) / 2 (after w_after - before w_before) in a share s of the time. At
  /// constant speed, a chord, an acceleration of a puts them a dt^2 / 12 ahead on the average, and lengths
  /// come out too large by a few 1e-5. Nothing next to a gap or to another segment.
  [[nodiscard]] Bend bend(std::size_t interval) const;
};

/// Counts as wheel angles. They begin within the first turn of the counter: a wheel's phase is the same in
/// every recording until the counter restarts.
class TickAngles {
 public:
  /// @param first sample of the drive
  TickAngles(const TickSample& first, double ticks_per_rev);
  /// Lengthens the track; a sample that does not advance in time is skipped.
  void append(const TickSample& sample, WheelTrack& track) const;
  /// rad, of one count
  [[nodiscard]] double tick_angle() const { return rad_per_tick_; }

 private:
  TickSample first_;
  double rad_per_tick_;
  double left_, right_;  ///< counts of the first sample, within one turn
};

/// Ticks of a recording as wheel angles; samples that do not advance in time are skipped.
WheelTrack wheel_track_from_ticks(const Recording& recording);

/// How far the wheels turned between two times, at constant speed between samples, beside the sensor's
/// motion.
WheelMotion motion_between(const WheelTrack& track, double begin, double end,
                           const math::Pose& sensor_motion);

/// Tuples laid end to end on one time axis; sample k is the start of tuple k.
WheelTrack wheel_track_from_increments(const Recording& recording);

/// Base parameters by the robot's papers; values that are missing stay zero.
inline BaseParameters nominal_base(const RobotDescription& robot) {
  BaseParameters base{
      robot.left_wheel_diameter / 2.0, robot.right_wheel_diameter / 2.0, robot.track_width, {}};
  if (robot.lidar_pose) base.mount = {(*robot.lidar_pose)[0], (*robot.lidar_pose)[1], (*robot.lidar_pose)[2]};
  return base;
}

/// The track with samples at most 30 ms apart. Where a wheel speeds up, constant speed between samples 0.1 s
/// apart runs ahead by a dt^2 / 12 on the average, and as that grows and fades with the acceleration it
/// lengthens wheels by some 0.1 %: between the samples of a segment the angles follow a cubic (modified
/// Akima: Akima 1970, J. ACM 17(4), eq. 3, with weights that keep a standing wheel still). Gaps of over half
/// a second stay as they are; where a wheel turned in one, a segment ends, for nobody knows when it turned.
WheelTrack finely_sampled(WheelTrack track);

}  // namespace odomcalib::calib::wheels
