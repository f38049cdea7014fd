// A planar pose graph as files hold it: vertices, measured motions between them, what is held fixed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/result.hpp"
#include "proto/unpack_limit.hpp"

namespace odomcalib {

enum class VertexKind {
  pose,   ///< x, y, yaw of the robot
  point,  ///< x, y of a landmark
};

struct GraphVertex {
  std::int64_t id = 0;  ///< as in the file; need not be dense or sorted
  VertexKind kind = VertexKind::pose;
  double x = 0.0;    ///< m, in the frame of the map
  double y = 0.0;    ///< m
  double yaw = 0.0;  ///< rad; 0 for points
  bool fixed = false;
};

/// A measured motion: vertex `to` as seen from pose `from`.
struct GraphEdge {
  std::size_t from = 0;  ///< position in PoseGraph::vertices; always a pose
  std::size_t to = 0;
  std::array<double, 3> motion{};  ///< x, y [m], yaw [rad] in the frame of `from`; yaw is 0 for points
  /// Upper triangle of the inverse covariance, row by row: xx xy xt yy yt tt [1/m^2, 1/(m rad), 1/rad^2].
  /// For points xt, yt and tt are 0.
  std::array<double, 6> information{};
};

/// Another number of a vertex: the file says that both are one place.
struct GraphAlias {
  std::int64_t id = 0;
  std::size_t vertex = 0;  ///< position in PoseGraph::vertices
};

struct PoseGraph {
  std::vector<GraphVertex> vertices;  ///< in the order of the file; each place once
  std::vector<GraphAlias> aliases;    ///< in the order of the file
  std::vector<GraphEdge> edges;       ///< in the order of the file
  bool has_positions = true;          ///< false: the file had edges only, all vertices are at the origin
  std::vector<std::string> notes;     ///< what was skipped in reading, one line each
};

/// Reads g2o text (VERTEX_SE2, EDGE_SE2, VERTEX_XY, EDGE_SE2_XY, FIX) and the older TORO text (VERTEX2,
/// EDGE2, also VERTEX and EDGE, EQUIV), whose information is ordered xx xy yy tt xt yt. Vertices that EQUIV
/// names as one place become one, the first of them in the file. Several files are read as one, e.g. vertices
/// and edges apart; any may be packed with gzip.
/// Error: io; format with file and line for anything that cannot be used as it stands.
Result<PoseGraph> read_pose_graph(std::span<const std::filesystem::path> files,
                                  const UnpackLimit& limit = {});

/// The same from memory. @param where names the text in errors
Result<PoseGraph> read_pose_graph_text(std::string_view text, const std::string& where);

/// g2o text with the shortest decimals that read back as the same numbers; headings in (-pi, pi]. An alias is
/// a vertex at the place that it names, and an EQUIV line; edges name the vertex itself, so programs that do
/// not know EQUIV see the same graph.
std::string to_g2o(const PoseGraph& graph);

}  // namespace odomcalib
