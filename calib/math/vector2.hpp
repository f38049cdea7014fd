// Points and directions of the plane under rigid motions.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::math {

/// A pose with its sine and cosine, for many points.
class Frame {
 public:
  explicit Frame(const Pose& pose)
      : origin_(pose.x, pose.y), cosine_(std::cos(pose.yaw)), sine_(std::sin(pose.yaw)) {}

  [[nodiscard]] const Eigen::Vector2d& origin() const { return origin_; }
  /// A direction of this frame in the frame of the pose.
  [[nodiscard]] Eigen::Vector2d rotate(const Eigen::Vector2d& v) const {
    return {cosine_ * v.x() - sine_ * v.y(), sine_ * v.x() + cosine_ * v.y()};
  }
  /// A point of this frame in the frame of the pose.
  [[nodiscard]] Eigen::Vector2d transform(const Eigen::Vector2d& p) const {
    return {origin_.x() + cosine_ * p.x() - sine_ * p.y(), origin_.y() + sine_ * p.x() + cosine_ * p.y()};
  }
  [[nodiscard]] Eigen::Matrix2d rotation() const {
    Eigen::Matrix2d m;
    m << cosine_, -sine_, sine_, cosine_;
    return m;
  }

 private:
  Eigen::Vector2d origin_;
  double cosine_, sine_;
};

/// Turned by 90 degrees, counter-clockwise.
inline Eigen::Vector2d quarter_turn(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

/// Unit vector along which points spread most: half the angle of (xx - yy, 2 xy), -90 to 90 degrees.
/// @param xx, xy, yy their moments about their centre
inline Eigen::Vector2d direction_of_spread(double xx, double xy, double yy) {
  const double size = std::hypot(xx - yy, 2.0 * xy);
  if (!(size > 0.0)) return {1.0, 0.0};
  const double cosine = (xx - yy) / size;  // of the double angle
  if (cosine >= 0.0) {
    const double c = std::sqrt(0.5 * (1.0 + cosine));
    return {c, xy / (size * c)};
  }
  const double s = std::copysign(std::sqrt(0.5 * (1.0 - cosine)), xy);
  return {xy / (size * s), s};
}

/// x, y and yaw of a minus those of b, the yaw in (-pi, pi].
inline Eigen::Vector3d difference(const Pose& a, const Pose& b) {
  return {a.x - b.x, a.y - b.y, wrap_angle(a.yaw - b.yaw)};
}

/// Rotation of (x, y, yaw) in other axes: yaw stays what it is.
inline Eigen::Matrix3d rotation_about_z(double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  Eigen::Matrix3d r;
  r << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return r;
}

}  // namespace odomcalib::calib::math
