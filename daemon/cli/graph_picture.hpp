// A pose graph as a picture.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "proto/recording/pose_graph.hpp"

namespace odomcalib::cli {

/// Surroundings that the robot saw, in the frame of the graph.
struct PictureMap {
  std::vector<Eigen::Vector2d> occupied;   ///< m, centres of cells
  double cell = 0.0;                       ///< m
  std::vector<Eigen::Vector2d> last_scan;  ///< m, seen from the last pose after
};

/// SVG with both trajectories in one frame to one scale, in the order of the vertices: `before` (grey,
/// dashed), `after` (blue), the edges that close loops (orange) and points (dots) as they are after, and
/// below all of them the map, if there is one: occupied cells (magenta), the last scan (green) and its rays
/// (yellow-green).
std::string graph_picture(const PoseGraph& before, const PoseGraph& after, const PictureMap& map = {});

}  // namespace odomcalib::cli
