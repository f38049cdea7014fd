#include "calib/slam/normal_equations.hpp"

namespace odomcalib::calib::slam {
namespace {

std::vector<Eigen::Index> block_sizes(const PoseGraph& graph, Freedom freedom) {
  std::vector<Eigen::Index> sizes;
  sizes.reserve(graph.vertices.size());
  for (const GraphVertex& vertex : graph.vertices) {
    const bool turns = freedom == Freedom::poses && vertex.kind == VertexKind::pose;
    sizes.push_back(vertex.fixed ? 0 : turns ? 3 : 2);
  }
  return sizes;
}

}  // namespace

std::vector<BlockLink> links_of(const PoseGraph& graph) {
  std::vector<BlockLink> links;
  links.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) links.emplace_back(edge.from, edge.to);
  return links;
}

NormalEquations::NormalEquations(const PoseGraph& graph, const std::vector<std::size_t>& places,
                                 Freedom freedom)
    : graph_(graph), hessian_(block_sizes(graph, freedom), links_of(graph), places) {
  slots_.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) slots_.push_back(hessian_.slot(edge.from, edge.to));
  right_side_.resize(hessian_.rows());
}

double NormalEquations::linearize(const Placement& at) {
  hessian_.set_zero();
  right_side_.setZero();
  double chi2 = 0.0;
  for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
    const Eigen::Vector3d error = edge_error(graph_.edges[k], at);
    chi2 += error.dot(information_of(graph_.edges[k]) * error);
    add_edge(k, at, error);
  }
  return chi2;
}

void NormalEquations::add_edge(std::size_t k, const Placement& at, const Eigen::Vector3d& error) {
  const GraphEdge& edge = graph_.edges[k];
  const EdgeJacobians J = edge_jacobians(edge, at);
  const Eigen::Matrix3d information = information_of(edge);
  const Eigen::Matrix3d weighted_from = J.from.transpose() * information;
  const Eigen::Matrix3d weighted_to = J.to.transpose() * information;
  const Eigen::Index from_size = hessian_.size(edge.from);
  const Eigen::Index to_size = hessian_.size(edge.to);
  if (from_size > 0) {
    hessian_.add_diagonal(edge.from, weighted_from * J.from);
    right_side_.segment(hessian_.row(edge.from), from_size) -= (weighted_from * error).head(from_size);
  }
  if (to_size > 0) {
    hessian_.add_diagonal(edge.to, weighted_to * J.to);
    right_side_.segment(hessian_.row(edge.to), to_size) -= (weighted_to * error).head(to_size);
  }
  if (from_size > 0 && to_size > 0) hessian_.add(slots_[k], edge.from, edge.to, weighted_from * J.to);
}

std::optional<std::size_t> NormalEquations::factorize(double lambda) {
  const auto singular = hessian_.factorize(lambda * hessian_.diagonal());
  if (!singular) return std::nullopt;
  for (std::size_t v = 0; v < graph_.vertices.size(); ++v)
    if (*singular >= hessian_.row(v) && *singular < hessian_.row(v) + hessian_.size(v)) return v;
  return std::nullopt;  // not reached: every row belongs to a vertex
}

// For (H + lambda D) dx = b the fall b'dx * 2 - dx'H dx is b'dx + lambda dx'D dx.
double NormalEquations::predicted_fall(const Eigen::VectorXd& step, double lambda) const {
  return right_side_.dot(step) + lambda * step.dot(hessian_.diagonal().cwiseProduct(step));
}

Placement NormalEquations::move(const Placement& at, const Eigen::VectorXd& step) const {
  Placement moved = at;
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Eigen::Index row = hessian_.row(v);
    if (hessian_.size(v) == 0) continue;
    moved[v].x += step[row];
    moved[v].y += step[row + 1];
    if (hessian_.size(v) == 3) moved[v].yaw = math::wrap_angle(moved[v].yaw + step[row + 2]);
  }
  return moved;
}

}  // namespace odomcalib::calib::slam
