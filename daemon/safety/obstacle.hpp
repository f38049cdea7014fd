// Rules M5, M6 and M10: nothing may stand where the robot will be before it can stop. This is an additional
// protection: it replaces neither a safety scanner nor an emergency stop.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "daemon/routines/motion.hpp"
#include "daemon/safety/settings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::safety {

/// A point in the base frame, m.
struct Point {
  double x = 0.0, y = 0.0;
};

/// Valid readings of a scan in the base frame. @param lidar_pose x, y [m], yaw [rad] of the lidar in the base
std::vector<Point> points_of(const Scan& scan, const std::array<double, 3>& lidar_pose);

/// The robot from above, m from the middle of the axle.
struct Footprint {
  double front = 0.25, back = 0.25, half_width = 0.25;
  [[nodiscard]] double radius() const;
};

/// Whether a point in the base frame lies on the robot, grown by so many m on all sides.
bool inside(const Point& point, const Footprint& footprint, double grow);

struct ObstacleOptions {
  Footprint footprint;
  double margin = settings::kMargin_m;           ///< m, ahead of the stopping distance
  double side_margin = settings::kSideMargin_m;  ///< m
  /// s, until the robot brakes: a period of the lidar, and what follows it. Before it is known: the longest
  /// one with which the robot may move.
  double reaction = settings::kScanTimeout + settings::kReaction_s;
  double acceleration = settings::kBraking;     ///< m/s^2, braking
  int points = settings::kPoints;               ///< so many readings are an obstacle
  int release_scans = settings::kReleaseScans;  ///< so many free scans in a row release
};

/// v t_react + v^2 / (2 a) + margin, m.
double stopping_distance(double speed, const ObstacleOptions& options);

/// m/s at which what the robot drives on, until a controller stops it that waits so long, stays within the
/// margin (rule M1).
/// @param watchdog_time s
double fastest_with(double watchdog_time);

/// Poses along the circle of the twist until `distance` m are driven, the present one included.
std::vector<routines::Pose> path_of(const routines::Twist& twist, double distance);

/// Turns with almost no forward speed are spins: their path would be a whole circle of a tiny radius.
bool is_spin(const routines::Twist& twist);

/// Readings inside the area that the robot sweeps until it can have stopped. Readings on the robot itself do
/// not count. A spin sweeps the full circle of its farthest corner.
std::vector<Point> in_way(const std::vector<Point>& points, const routines::Twist& twist,
                          const ObstacleOptions& options);

/// One scan with enough points blocks; release_scans free ones in a row release.
class ObstacleGuard {
 public:
  explicit ObstacleGuard(ObstacleOptions options) : options_(options) {}
  void seen(const std::vector<Point>& points, const routines::Twist& twist);
  /// A scan of that time has come, s: the stopping distance counts the lidar's period as it is.
  void turned(double t);
  /// And the drive as it brakes. @param overrun s, see Braking
  void brakes(double overrun) { overrun_ = overrun; }
  [[nodiscard]] bool blocked() const { return nearest_.has_value(); }
  /// The obstacle that blocks, and where; nullopt: none.
  [[nodiscard]] std::optional<std::string> obstacle() const;
  /// With what was measured of lidar and drive.
  [[nodiscard]] ObstacleOptions options() const;

 private:
  ObstacleOptions options_;
  std::deque<double> scan_times_;  // s
  double overrun_ = 0.0;           // s
  std::optional<Point> nearest_;   // reading in the way, while it is blocked
  int free_scans_ = 0;
};

/// m from the middle of the axle to the farthest point that is nearer than `clearance` to the footprint.
double reach_of(const Footprint& footprint, double clearance);

/// Before a motion: points nearer than `clearance` to the footprint anywhere on the previewed path.
/// @return what is in the way, with its place, or nullopt
std::optional<std::string> occupied(const std::vector<Point>& points, const routines::Preview& preview,
                                    const Footprint& footprint, double clearance);

}  // namespace odomcalib::safety
