// A pose graph as a picture.
#pragma once

#include <string>

#include "proto/pose_graph.hpp"

namespace odomcalib::cli {

/// SVG with both trajectories in one frame to one scale, in the order of the vertices: `before` (grey,
/// dashed), `after` (blue), the edges that close loops (orange) and points (dots) as they are after.
std::string graph_picture(const PoseGraph& before, const PoseGraph& after);

}  // namespace odomcalib::cli
