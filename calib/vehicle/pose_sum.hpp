// Constant twists, added up to a pose.
#pragma once

#include <complex>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::vehicle {

/// Begins at the origin. The heading is turned on by each step: an angle's sine and cosine, computed in every
/// step of every fit, cost more than all the rest.
class PoseSum {
 public:
  [[nodiscard]] const math::Pose& pose() const { return pose_; }
  /// Cosine and sine of the heading.
  [[nodiscard]] const std::complex<double>& heading() const { return heading_; }
  /// @param w motion over the interval (x, y, yaw of the group's logarithm)
  void add(const math::Pose& w) {
    const math::ArcRatios<double> ratio(w.yaw);
    const std::complex<double> chord(ratio.sine, ratio.cosine);
    const std::complex<double> way = heading_ * (chord * std::complex<double>(w.x, w.y));
    pose_ = {pose_.x + way.real(), pose_.y + way.imag(), pose_.yaw + w.yaw};
    heading_ *= std::complex<double>(1.0 - w.yaw * ratio.cosine, w.yaw * ratio.sine);
  }

 private:
  math::Pose pose_;
  std::complex<double> heading_ = 1.0;
};

}  // namespace odomcalib::calib::vehicle
