// Where the lidar looks. What it cannot see is not free: a sensor of 270 degrees knows nothing of what stands
// behind the robot, nor does one behind whose back the robot's own body rises (rules M5, M10).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "daemon/safety/obstacle.hpp"
#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {

/// Directions from the lidar, in the axes of the base, rad: 0 ahead, counter-clockwise from `from` to `to`,
/// which is larger by the width.
struct Sector {
  double from = 0.0, to = 0.0;
};

/// "135 to 225 deg", joined by commas; 0 is ahead, 90 left.
std::string text_of(const std::vector<Sector>& sectors);

/// Area hidden from the lidar.
class BlindArea {
 public:
  static constexpr std::size_t kBins = settings::kBins;
  using Bins = std::array<bool, kBins>;

  BlindArea(const Point& eye, const Bins& blind) : eye_(eye), blind_(blind) {}
  /// Whether nothing is known of a point in the base frame.
  [[nodiscard]] bool hides(const Point& point) const;
  [[nodiscard]] std::vector<Sector> sectors() const;
  [[nodiscard]] static std::size_t bin_of(double direction);

 private:
  Point eye_;
  Bins blind_;
};

/// The directions in which beams went out within the last second. A beam without an echo says that the way is
/// free up to the range of the lidar; one that ends on the robot itself says nothing of what is behind.
/// Gaps of less than six degrees are none: no obstacle hides in the shadow of a thin post for long.
class Cover {
 public:
  Cover();
  /// @param lidar_pose x, y [m], yaw [rad] of the lidar in the base
  void seen(const Scan& scan, const std::array<double, 3>& lidar_pose, const Footprint& footprint,
            double now);
  [[nodiscard]] BlindArea blind(double now) const;

 private:
  using Times = std::array<double, BlindArea::kBins>;
  Point eye_;
  Times free_at_{}, robot_at_{};  // s, when a beam last went out, and last ended on the robot
};

/// Names of the moves, each once, that go where the lidar does not look: not all of what they sweep until the
/// robot can stop would show.
std::vector<std::string> unseen_moves(const routines::Plan& plan, const BlindArea& blind,
                                      const ObstacleOptions& options);

}  // namespace odomcalib::safety
