#include "calib/slam/robust_weights.hpp"

#include <utility>

#include "calib/slam/edge_error.hpp"
#include "calib/slam/optimize.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

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
