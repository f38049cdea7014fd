// How a graph hangs together: neighbours, parts, spanning trees, and loops turned the wrong way round.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calib/slam/edge_error.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

/// Edges at each vertex, in the order of the file. Edges with zero information connect nothing.
class Neighbours {
 public:
  explicit Neighbours(const PoseGraph& graph);
  /// Positions in PoseGraph::edges.
  [[nodiscard]] std::span<const std::size_t> edges_at(std::size_t vertex) const {
    return {edges_.data() + begins_[vertex], begins_[vertex + 1] - begins_[vertex]};
  }

 private:
  std::vector<std::size_t> begins_;
  std::vector<std::size_t> edges_;
};

/// Number of the connected part that each vertex belongs to, counted from 0 in the order of first vertices.
struct Parts {
  std::vector<std::size_t> of;  ///< per vertex
  std::size_t count = 0;
};
Parts connected_parts(const PoseGraph& graph, const Neighbours& neighbours);

/// Place of every vertex in the order of ids, poses before points.
std::vector<std::size_t> ranks_by_id(const PoseGraph& graph);
/// Between poses whose ids follow each other: odometry.
bool joins_neighbours(const PoseGraph& graph, const std::vector<std::size_t>& ranks, const GraphEdge& edge);

/// One way from the roots to every vertex that can be placed from them.
struct SpanningTree {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  struct Step {
    std::size_t vertex = 0;
    std::size_t edge = kNone;  ///< that leads to it; kNone: a root
  };
  std::vector<Step> steps;  ///< a vertex comes after the one that it is reached from
};

enum class TreeKind {
  breadth_first,  ///< as few edges as possible to each vertex
  odometry,       ///< edges between poses of neighbouring ids wherever there are any
};

/// Roots are the fixed poses. Trees do not pass through points, which have no heading to go on from.
SpanningTree spanning_tree(const PoseGraph& graph, const Neighbours& neighbours, TreeKind kind);

/// Composes the measured motions along the tree; vertices outside of it stay where `at` has them.
Placement placed_along(const PoseGraph& graph, const SpanningTree& tree, Placement at);

/// Loops (one for each edge outside a breadth-first tree) around which the heading errors add up to more than
/// half a turn. At a false minimum a whole turn is spread over a loop, a little on each edge, so that no edge
/// looks wrong by itself; added up it shows. Noise alone does that only in long, very noisy loops.
std::size_t loops_with_a_turn_too_much(const PoseGraph& graph, const Neighbours& neighbours,
                                       const Placement& at);

}  // namespace odomcalib::calib::slam
