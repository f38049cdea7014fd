// Walls of a room in one frame, and which of them a beam strikes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/matching/surface.hpp"
#include "calib/matching/walls.hpp"
#include "calib/math/vector2.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

/// Beam of a scan, in the sensor's frame at the middle of the sweep.
struct Beam {
  Eigen::Vector2d origin;     ///< m, where the sensor was when it shot
  Eigen::Vector2d direction;  ///< of length 1
  double range = 0.0;         ///< m
};

/// Beams with a usable reading.
/// @param motion of the sensor within the sweep
std::vector<Beam> make_beams(const Scan& scan, const matching::BeamMotion& motion);

struct MapWall {
  Eigen::Vector2d centre;  ///< m
  Eigen::Vector2d normal;  ///< of length 1, towards where it was seen from
  double low = 0.0;        ///< m, ends of what was seen, along `direction()` from `centre`
  double high = 0.0;
  matching::LineSums sums;  ///< readings that made it, in the map's frame
  [[nodiscard]] Eigen::Vector2d direction() const { return {-normal.y(), normal.x()}; }
};

/// A beam and the wall it strikes.
struct Strike {
  std::size_t beam = 0;
  std::size_t wall = 0;
};

/// Term of a reading for the pose of the sensor and for its wall: range read minus range expected, and its
/// derivatives. All taken at the expected point, which the noise of the reading does not shift: otherwise
/// noise and derivative would be correlated, and the estimate biased.
struct RangeTerm {
  double residual = 0.0;     ///< m
  double variance = 0.0;     ///< m^2
  terms::Sighting sighting;  ///< range and incidence where the beam meets the wall; no bearing
  Eigen::Vector3d by_pose;   ///< of the residual by x, y (map axes) and yaw of the sensor
  Eigen::Vector2d by_wall;   ///< by the shift of the wall along its normal and its turn about its centre
};

class WallMap {
 public:
  [[nodiscard]] const std::vector<MapWall>& walls() const { return walls_; }
  std::vector<MapWall>& walls() { return walls_; }

  /// Takes in what one scan saw of walls; pieces of a wall that is known extend it.
  /// @param sensor pose of the scan in the map
  void insert(const matching::Walls& seen, const math::Pose& sensor);

  /// Drops pieces that lie along a longer wall, not recognised as a part of it while the map grew: beams
  /// would strike whichever their noise makes the nearer one.
  /// @param tolerance m, of both their ends from the wall's line
  /// @return whether there were any
  bool drop_doubles(double tolerance);

  /// For each beam the nearest wall on its way; beams that would strike just beyond what was seen of a wall
  /// are left out, since they may as well miss it, and so are those that strike too flat.
  [[nodiscard]] std::vector<Strike> strikes(const std::vector<Beam>& beams, const math::Pose& sensor) const;

  /// @param sensor pose in the map
  [[nodiscard]] RangeTerm term(const Beam& beam, std::size_t wall, const math::Frame& sensor,
                               double range_noise) const;

 private:
  [[nodiscard]] MapWall* find_similar(const MapWall& wall);
  [[nodiscard]] std::optional<std::size_t> struck_by(const Eigen::Vector2d& from,
                                                     const Eigen::Vector2d& direction,
                                                     std::span<const std::uint32_t> near) const;
  std::vector<MapWall> walls_;
};

}  // namespace odomcalib::calib::measurement
