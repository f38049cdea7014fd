#include "calib/slam/connectivity.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <tuple>

namespace odomcalib::calib::slam {
namespace {

bool has_information(const GraphEdge& edge) {
  return std::any_of(edge.information.begin(), edge.information.end(), [](double i) { return i != 0.0; });
}

std::size_t other_end(const GraphEdge& edge, std::size_t vertex) {
  return edge.from == vertex ? edge.to : edge.from;
}

/// Vertices to visit next; those behind odometry edges are taken first if that is wanted.
class Frontier {
 public:
  Frontier(const PoseGraph& graph, TreeKind kind)
      : graph_(graph), ranks_(kind == TreeKind::odometry ? ranks_by_id(graph) : std::vector<std::size_t>{}) {}
  void add(SpanningTree::Step step) { (is_odometry(step) ? first_ : later_).push_back(step); }
  [[nodiscard]] bool empty() const { return first_.empty() && later_.empty(); }
  SpanningTree::Step take() {
    auto& queue = first_.empty() ? later_ : first_;
    const SpanningTree::Step step = queue.front();
    queue.pop_front();
    return step;
  }

 private:
  [[nodiscard]] bool is_odometry(const SpanningTree::Step& step) const {
    if (ranks_.empty() || step.edge == SpanningTree::kNone) return false;
    return joins_neighbours(graph_, ranks_, graph_.edges[step.edge]);
  }
  const PoseGraph& graph_;
  std::vector<std::size_t> ranks_;
  std::deque<SpanningTree::Step> first_;
  std::deque<SpanningTree::Step> later_;
};

math::Pose motion_of(const GraphEdge& edge) { return {edge.motion[0], edge.motion[1], edge.motion[2]}; }

}  // namespace

Neighbours::Neighbours(const PoseGraph& graph) : begins_(graph.vertices.size() + 1, 0) {
  for (const GraphEdge& edge : graph.edges) {
    if (!has_information(edge)) continue;
    ++begins_[edge.from + 1];
    ++begins_[edge.to + 1];
  }
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  edges_.resize(begins_.back());
  auto next = begins_;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (!has_information(graph.edges[k])) continue;
    edges_[next[graph.edges[k].from]++] = k;
    edges_[next[graph.edges[k].to]++] = k;
  }
}

std::vector<std::size_t> ranks_by_id(const PoseGraph& graph) {
  std::vector<std::size_t> order(graph.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&graph](std::size_t a, std::size_t b) {
    const auto& [va, vb] = std::tie(graph.vertices[a], graph.vertices[b]);
    return va.kind != vb.kind ? va.kind < vb.kind : va.id < vb.id;
  });
  std::vector<std::size_t> ranks(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) ranks[order[rank]] = rank;
  return ranks;
}

bool joins_neighbours(const PoseGraph& graph, const std::vector<std::size_t>& ranks, const GraphEdge& edge) {
  const std::size_t a = ranks[edge.from];
  const std::size_t b = ranks[edge.to];
  return graph.vertices[edge.to].kind == VertexKind::pose && (a + 1 == b || b + 1 == a);
}

Parts connected_parts(const PoseGraph& graph, const Neighbours& neighbours) {
  constexpr std::size_t kUnseen = SpanningTree::kNone;
  Parts parts{std::vector<std::size_t>(graph.vertices.size(), kUnseen), 0};
  std::vector<std::size_t> open;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (parts.of[v] != kUnseen) continue;
    parts.of[v] = parts.count;
    open.push_back(v);
    while (!open.empty()) {
      const std::size_t here = open.back();
      open.pop_back();
      for (const std::size_t edge : neighbours.edges_at(here)) {
        const std::size_t there = other_end(graph.edges[edge], here);
        if (parts.of[there] != kUnseen) continue;
        parts.of[there] = parts.count;
        open.push_back(there);
      }
    }
    ++parts.count;
  }
  return parts;
}

SpanningTree spanning_tree(const PoseGraph& graph, const Neighbours& neighbours, TreeKind kind) {
  SpanningTree tree;
  std::vector<bool> reached(graph.vertices.size(), false);
  Frontier frontier(graph, kind);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v)
    if (graph.vertices[v].fixed) frontier.add({v, SpanningTree::kNone});
  while (!frontier.empty()) {
    const SpanningTree::Step step = frontier.take();
    if (reached[step.vertex]) continue;
    reached[step.vertex] = true;
    tree.steps.push_back(step);
    if (graph.vertices[step.vertex].kind == VertexKind::point) continue;
    for (const std::size_t edge : neighbours.edges_at(step.vertex)) {
      const std::size_t there = other_end(graph.edges[edge], step.vertex);
      if (!reached[there]) frontier.add({there, edge});
    }
  }
  return tree;
}

Placement placed_along(const PoseGraph& graph, const SpanningTree& tree, Placement at) {
  for (const auto& [vertex, k] : tree.steps) {
    if (k == SpanningTree::kNone) continue;
    const GraphEdge& edge = graph.edges[k];
    const bool forward = edge.to == vertex;
    const math::Pose& before = at[other_end(edge, vertex)];
    const math::Pose placed = compose(before, forward ? motion_of(edge) : inverse(motion_of(edge)));
    at[vertex] = {placed.x, placed.y, math::wrap_angle(placed.yaw)};
  }
  return at;
}

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
