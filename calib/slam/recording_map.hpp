// From a recording to a map: scans and odometry make a graph (scan_graph.hpp), the settled graph places the
// scans, and the scans fill a grid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/slam/scan_graph.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::slam {

struct RecordingMap {
  ScanGraph made;         ///< vertices are keyframes; `scans` are positions in Recording::scans
  PoseGraph by_odometry;  ///< the same keyframes where odometry alone puts them, from the same first pose
  std::vector<Eigen::Vector2d> occupied;   ///< m, centres of cells that are probably occupied
  double cell = 0.0;                       ///< m
  std::vector<Eigen::Vector2d> last_scan;  ///< m, what was seen from the last keyframe
  double range_noise = 0.0;                ///< m, standard deviation of a range, estimated from the scans
};

/// The poses are those of the lidar, the first one is the origin. Odometry is that of the nominal robot; what
/// it does wrong all the time is learnt on the way.
/// Errors: empty (no ticks, fewer than two keyframes), missing_units.
Result<RecordingMap> map_recording(const Recording& recording, ScanGraphOptions options);

}  // namespace odomcalib::calib::slam
