#include "calib/slam/optimize.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "calib/slam/connectivity.hpp"
#include "calib/slam/descent.hpp"
#include "calib/slam/edge_error.hpp"
#include "calib/slam/first_guess.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

std::string name_of(const GraphVertex& vertex) {
  return (vertex.kind == VertexKind::pose ? "pose " : "point ") + std::to_string(vertex.id);
}

/// Numbers that the edges measure: directions without any information do not count.
std::size_t measured_numbers(const PoseGraph& graph) {
  std::size_t count = 0;
  for (const GraphEdge& edge : graph.edges) {
    const auto& [xx, xy, xt, yy, yt, tt] = edge.information;
    count += (xx > 0.0 ? 1U : 0U) + (yy > 0.0 ? 1U : 0U) + (tt > 0.0 ? 1U : 0U);
  }
  return count;
}

struct Obstacle {
  GraphState state;
  std::string reason;
};

/// A graph that can be solved, or why it cannot.
class Problem {
 public:
  explicit Problem(const PoseGraph& graph)
      : graph_(graph),
        neighbours_(graph),
        places_(elimination_places(graph.vertices.size(), links_of(graph))) {}

  /// Vertices without edges stay where they are.
  void hold_loose_vertices(std::vector<std::string>& notes);
  [[nodiscard]] std::optional<Obstacle> obstacle() const;
  [[nodiscard]] Placement guess(GraphStart start) const;
  [[nodiscard]] Descent descend_from(GraphStart start, const GraphOptions& options,
                                     const GraphObserver& observer) const {
    return descend(graph_, places_, guess(start), options, observer);
  }
  [[nodiscard]] bool looks_wrong(const Descent& descent) const {
    return descent.state != GraphState::converged || descent.iterations.size() > settings::kManyIterations ||
           loops_with_a_turn_too_much(graph_, neighbours_, descent.at) > 0;
  }
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }

 private:
  [[nodiscard]] std::optional<Obstacle> loose_part() const;
  [[nodiscard]] std::optional<Obstacle> pose_behind_points() const;

  PoseGraph graph_;
  Neighbours neighbours_;
  std::vector<std::size_t> places_;
};

void Problem::hold_loose_vertices(std::vector<std::string>& notes) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < graph_.vertices.size(); ++v) {
    if (!neighbours_.edges_at(v).empty() || graph_.vertices[v].fixed) continue;
    graph_.vertices[v].fixed = true;
    if (count++ == 0) notes.push_back(name_of(graph_.vertices[v]) + " has no edge and stays where it is");
  }
  if (count > 1) notes.back() += "; so do " + std::to_string(count - 1) + " more";
}

std::optional<Obstacle> Problem::obstacle() const {
  const bool anything_fixed = std::any_of(graph_.vertices.begin(), graph_.vertices.end(),
                                          [](const GraphVertex& vertex) { return vertex.fixed; });
  if (!anything_fixed)
    return Obstacle{GraphState::no_gauge, "no vertex is fixed, the whole graph could be moved; fix one pose"};
  if (auto part = loose_part()) return part;
  return graph_.has_positions ? std::nullopt : pose_behind_points();
}

/// A fixed pose holds its part of the graph, and so do two fixed points. What has no edge needs no hold.
std::optional<Obstacle> Problem::loose_part() const {
  const Parts parts = connected_parts(graph_, neighbours_);
  std::vector<int> held(parts.count, 0);
  for (std::size_t v = 0; v < graph_.vertices.size(); ++v)
    if (graph_.vertices[v].fixed) held[parts.of[v]] += graph_.vertices[v].kind == VertexKind::pose ? 2 : 1;
  for (std::size_t v = 0; v < graph_.vertices.size(); ++v) {
    if (held[parts.of[v]] >= 2 || neighbours_.edges_at(v).empty()) continue;
    const auto size = std::count(parts.of.begin(), parts.of.end(), parts.of[v]);
    const std::string id = std::to_string(graph_.vertices[v].id);
    return Obstacle{GraphState::not_connected,
                    name_of(graph_.vertices[v]) + " and " + std::to_string(size - 1) +
                        " more vertices do not hang together with a fixed pose; add the missing edges, or " +
                        "\"FIX " + id + "\" to place this part by its own values"};
  }
  return std::nullopt;
}

std::optional<Obstacle> Problem::pose_behind_points() const {
  std::vector<bool> reached(graph_.vertices.size(), false);
  for (const auto& step : spanning_tree(graph_, neighbours_, TreeKind::breadth_first).steps)
    reached[step.vertex] = true;
  const auto first = std::find(reached.begin(), reached.end(), false);
  if (first == reached.end()) return std::nullopt;
  const auto& vertex = graph_.vertices[static_cast<std::size_t>(first - reached.begin())];
  return Obstacle{GraphState::not_connected,
                  name_of(vertex) +
                      " is connected through points only, which give no heading to start from; " +
                      "give the vertices with first values"};
}

Placement Problem::guess(GraphStart start) const {
  Placement given = placement_of(graph_);
  if (start == GraphStart::file) return given;
  const auto kind = start == GraphStart::odometry ? TreeKind::odometry : TreeKind::breadth_first;
  const Placement tree = placed_along(graph_, spanning_tree(graph_, neighbours_, kind), given);
  return start == GraphStart::rotations ? rotations_first(graph_, places_, tree) : tree;
}

struct Attempt {
  GraphStart start;
  Descent descent;
};

/// The start that was asked for, else rotations first; and where there is reason for doubt the other first
/// guesses too: the lowest chi2 counts.
Attempt best_attempt(const Problem& problem, const GraphOptions& options, const GraphObserver& observer) {
  const bool any_start = options.start == GraphStart::automatic;
  const GraphStart first = any_start ? GraphStart::rotations : options.start;
  Attempt best{first, problem.descend_from(first, options, observer)};
  std::vector<GraphStart> others;
  if (problem.looks_wrong(best.descent)) {
    others = {GraphStart::rotations, GraphStart::tree, GraphStart::odometry};
    std::erase(others, first);
  }
  const bool file_is_lower = any_start && problem.graph().has_positions &&
                             chi2(problem.graph(), placement_of(problem.graph())) < best.descent.chi2;
  if (file_is_lower) others.push_back(GraphStart::file);
  for (const GraphStart start : others) {
    Attempt other{start, problem.descend_from(start, options, observer)};
    const bool better = other.descent.chi2 < best.descent.chi2 * (1.0 - options.tolerance);
    const bool cured = best.descent.state != GraphState::converged &&
                       other.descent.state == GraphState::converged &&
                       other.descent.chi2 <= best.descent.chi2;
    if (better || cured) best = std::move(other);
  }
  return best;
}

std::string reason_of(const Descent& descent, const PoseGraph& graph) {
  switch (descent.state) {
    case GraphState::stalled:
      return "no step lowers chi2 further; rounding or a very flat minimum";
    case GraphState::iteration_limit:
      return "chi2 was still falling when the iterations ran out; allow more";
    case GraphState::singular:
      return "the edges leave " + name_of(graph.vertices[*descent.undetermined]) +
             " undetermined; look for zeros in the information of its edges";
    case GraphState::not_finite:
      return "the numbers are too large to compute with; positions are in m, information in 1/m^2";
    default:
      return "";
  }
}

void write_back(PoseGraph& graph, const Placement& at) {
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    GraphVertex& vertex = graph.vertices[v];
    if (vertex.fixed) continue;
    vertex.x = at[v].x;
    vertex.y = at[v].y;
    vertex.yaw = vertex.kind == VertexKind::pose ? math::wrap_angle(at[v].yaw) : 0.0;
  }
}

std::size_t free_coordinates(const PoseGraph& graph) {
  std::size_t count = 0;
  for (const GraphVertex& vertex : graph.vertices)
    if (!vertex.fixed) count += vertex.kind == VertexKind::pose ? 3 : 2;
  return count;
}

double cauchy_weight(double chi2) {
  return 1.0 / (1.0 + chi2 / (settings::kCauchyCut * settings::kCauchyCut));
}

/// Weighs every edge by how far it is from the graph as it lies.
void weigh(PoseGraph& graph, const std::vector<GraphEdge>& as_measured) {
  const Placement at = placement_of(graph);
  for (std::size_t e = 0; e < as_measured.size(); ++e) {
    const double weight = cauchy_weight(chi2(as_measured[e], at));
    for (std::size_t i = 0; i < as_measured[e].information.size(); ++i)
      graph.edges[e].information.at(i) = weight * as_measured[e].information.at(i);
  }
}

}  // namespace

std::size_t fix_first_pose(PoseGraph& graph) {
  auto& vertices = graph.vertices;
  if (std::any_of(vertices.begin(), vertices.end(), [](const GraphVertex& v) { return v.fixed; }))
    return vertices.size();
  const auto pose = std::find_if(vertices.begin(), vertices.end(),
                                 [](const GraphVertex& v) { return v.kind == VertexKind::pose; });
  if (pose != vertices.end()) pose->fixed = true;
  return static_cast<std::size_t>(pose - vertices.begin());
}

void place_along_odometry(PoseGraph& graph) { write_back(graph, Problem(graph).guess(GraphStart::odometry)); }

double graph_chi2(const PoseGraph& graph) { return chi2(graph, placement_of(graph)); }

GraphSummary optimize_graph(PoseGraph& graph, const GraphOptions& options, const GraphObserver& observer) {
  GraphSummary summary;
  summary.chi2_before = graph_chi2(graph);
  Problem problem(graph);
  problem.hold_loose_vertices(summary.notes);
  summary.measured = measured_numbers(graph);
  summary.unknowns = free_coordinates(problem.graph());
  if (const auto obstacle = problem.obstacle()) {
    summary.state = obstacle->state;
    summary.reason = obstacle->reason;
    return summary;
  }
  // Who names both a start and a method wants to see what that leads to.
  const bool to_the_letter =
      options.start != GraphStart::automatic && options.method != GraphMethod::automatic;
  Attempt attempt = to_the_letter
                        ? Attempt{options.start, problem.descend_from(options.start, options, observer)}
                        : best_attempt(problem, options, observer);
  summary.start = attempt.start;
  summary.chi2_start = attempt.descent.chi2_start;
  summary.chi2_after = attempt.descent.chi2;
  summary.state = attempt.descent.state;
  summary.reason = reason_of(attempt.descent, graph);
  summary.iterations = std::move(attempt.descent.iterations);
  if (!summary.is_usable()) return summary;
  write_back(graph, attempt.descent.at);
  graph.has_positions = true;
  return summary;
}

bool settle_robustly(PoseGraph& graph) {
  PoseGraph weighed = graph;
  for (int round = 0; round < settings::kWeightRounds; ++round) {
    if (!optimize_graph(weighed, {.start = GraphStart::file}).is_usable()) return false;
    weigh(weighed, graph.edges);
  }
  if (!optimize_graph(weighed, {.start = GraphStart::file}).is_usable()) return false;
  graph = std::move(weighed);
  return true;
}

}  // namespace odomcalib::calib::slam
