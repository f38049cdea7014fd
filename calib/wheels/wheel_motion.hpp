// The input common to all estimators: what the wheels did and how the sensor moved, over one interval.
#pragma once

#include "calib/math/se2.hpp"

namespace odomcalib::calib::wheels {

struct WheelMotion {
  double left = 0.0;  ///< wheel rotation in the interval, rad
  double right = 0.0;
  math::Pose sensor_motion;  ///< measured motion of the sensor, in its frame at the start of the interval
};

/// Wheel radii in m, track width in m, sensor pose on the base.
struct BaseParameters {
  double left_radius = 0.0;
  double right_radius = 0.0;
  double track_width = 0.0;
  math::Pose mount;
};

/// Base motion over an interval of constant wheel speeds: an exact arc.
template <typename T>
math::Pose2<T> wheel_arc(const T& left_travel, const T& right_travel, const T& track_width) {
  return math::exp_se2<T>((left_travel + right_travel) / 2.0, T(0.0),
                          (right_travel - left_travel) / track_width);
}

}  // namespace odomcalib::calib::wheels
