#include "calib/slam/loops.hpp"

#include <cmath>

namespace odomcalib::calib::slam {

std::size_t loops_with_a_turn_too_much(const PoseGraph& graph, const Neighbours& neighbours,
                                       const Placement& at) {
  const SpanningTree tree = spanning_tree(graph, neighbours, TreeKind::breadth_first);
  std::vector<double> error_from_root(graph.vertices.size(), 0.0);
  std::vector<bool> in_tree(graph.edges.size(), false);
  for (const auto& [vertex, k] : tree.steps) {
    if (k == SpanningTree::kNone) continue;
    const GraphEdge& edge = graph.edges[k];
    const double error = edge_error(edge, at)[2];
    in_tree[k] = true;
    error_from_root[vertex] =
        edge.to == vertex ? error_from_root[edge.from] + error : error_from_root[edge.to] - error;
  }
  std::size_t loops = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (in_tree[k] || edge.information[5] == 0.0) continue;
    const double around = error_from_root[edge.from] + edge_error(edge, at)[2] - error_from_root[edge.to];
    if (std::abs(around) > math::kPi) ++loops;
  }
  return loops;
}

}  // namespace odomcalib::calib::slam
