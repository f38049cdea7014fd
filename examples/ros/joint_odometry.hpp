// Common part of both nodes, without ROS: joint states in, the numbers of nav_msgs/Odometry out.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <odomcalib/odometry.hpp>
#include <string>
#include <utility>
#include <vector>

/// Row by row of x, y, z, roll, pitch, yaw, as messages of ROS have it.
using Covariance36 = std::array<double, 36>;

class JointOdometry {
 public:
  JointOdometry(odomcalib::Odometry odometry, std::string left, std::string right)
      : odometry_(std::move(odometry)), left_(std::move(left)), right_(std::move(right)) {}

  /// Whether the message had both wheels and moved odometry on; problem() says what was wrong with a sample.
  bool update(double stamp, const std::vector<std::string>& names, const std::vector<double>& positions) {
    const std::size_t left = place_of(names, left_), right = place_of(names, right_);
    if (left >= positions.size() || right >= positions.size()) return false;
    return odometry_.update_angles(stamp, positions[left], positions[right]) == ODOMCALIB_OK;
  }

  [[nodiscard]] odomcalib::Pose pose() const { return odometry_.pose(); }
  /// z and w of the heading's quaternion; x and y are zero.
  [[nodiscard]] std::array<double, 2> heading() const {
    return {std::sin(0.5 * pose().yaw), std::cos(0.5 * pose().yaw)};
  }
  [[nodiscard]] odomcalib::Velocity velocity() const { return odometry_.velocity(); }
  [[nodiscard]] Covariance36 pose_covariance() const { return in_space(odometry_.covariance()); }
  [[nodiscard]] Covariance36 velocity_covariance() const { return in_space(odometry_.velocity_covariance()); }
  [[nodiscard]] const char* problem() const { return odometry_.problem(); }

 private:
  /// Beyond the end where it is absent.
  static std::size_t place_of(const std::vector<std::string>& names, const std::string& name) {
    std::size_t place = 0;
    while (place < names.size() && names[place] != name) ++place;
    return place < names.size() ? place : static_cast<std::size_t>(-1);
  }

  /// Height, roll and pitch are none of a plane's: filters must not take them for known.
  static Covariance36 in_space(const odomcalib::Covariance& plane) {
    constexpr std::array<std::size_t, 3> kAxes = {0, 1, 5};
    constexpr double kUnknown = 1e6;
    Covariance36 all{};
    for (const std::size_t axis : {std::size_t{2}, std::size_t{3}, std::size_t{4}}) all[7 * axis] = kUnknown;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        all[6 * kAxes[row] + kAxes[column]] = plane[3 * row + column];
    return all;
  }

  odomcalib::Odometry odometry_;
  std::string left_, right_;
};
