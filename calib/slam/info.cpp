#include "calib/slam/info.hpp"

#include <algorithm>
#include <cmath>

#include "calib/slam/connectivity.hpp"
#include "calib/slam/edge_error.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

void count_vertices_and_edges(const PoseGraph& graph, GraphInfo& info) {
  for (const GraphVertex& vertex : graph.vertices) {
    ++(vertex.kind == VertexKind::pose ? info.poses : info.points);
    if (vertex.fixed) ++info.fixed;
  }
  for (const GraphEdge& edge : graph.edges)
    ++(graph.vertices[edge.to].kind == VertexKind::pose ? info.pose_edges : info.point_edges);
}

double path_length(const PoseGraph& graph) {
  const auto odometry = odometry_edges(graph);
  double length = 0.0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (odometry[k]) length += std::hypot(graph.edges[k].motion[0], graph.edges[k].motion[1]);
  return length;
}

std::vector<WorstEdge> worst_edges(const PoseGraph& graph, const Placement& at) {
  std::vector<WorstEdge> edges;
  edges.reserve(graph.edges.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) edges.push_back({k, chi2(graph.edges[k], at)});
  std::stable_sort(edges.begin(), edges.end(),
                   [](const WorstEdge& a, const WorstEdge& b) { return a.chi2 > b.chi2; });
  edges.resize(std::min(edges.size(), settings::kWorstEdges));
  return edges;
}

/// Trees begin at fixed poses: one in each part, so that every loop is seen.
PoseGraph with_roots(PoseGraph graph, const Parts& parts) {
  std::vector<bool> rooted(parts.count, false);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v)
    rooted[parts.of[v]] = rooted[parts.of[v]] || graph.vertices[v].fixed;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (rooted[parts.of[v]] || graph.vertices[v].kind == VertexKind::point) continue;
    graph.vertices[v].fixed = true;
    rooted[parts.of[v]] = true;
  }
  return graph;
}

}  // namespace

std::vector<bool> odometry_edges(const PoseGraph& graph) {
  const auto ranks = ranks_by_id(graph);
  std::vector<bool> odometry;
  odometry.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) odometry.push_back(joins_neighbours(graph, ranks, edge));
  return odometry;
}

GraphInfo inspect_graph(const PoseGraph& graph) {
  GraphInfo info;
  const Neighbours neighbours(graph);
  const Parts parts = connected_parts(graph, neighbours);
  const Placement at = placement_of(graph);
  count_vertices_and_edges(graph, info);
  info.parts = parts.count;
  std::size_t connecting = 0;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) connecting += neighbours.edges_at(v).size();
  info.loops = connecting / 2 + parts.count - graph.vertices.size();
  info.path_length = path_length(graph);
  info.chi2 = chi2(graph, at);
  info.turned_loops = loops_with_a_turn_too_much(with_roots(graph, parts), neighbours, at);
  info.worst_edges = worst_edges(graph, at);
  return info;
}

}  // namespace odomcalib::calib::slam
