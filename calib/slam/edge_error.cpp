#include "calib/slam/edge_error.hpp"

namespace odomcalib::calib::slam {
namespace {

math::Pose measured(const GraphEdge& edge) { return {edge.motion[0], edge.motion[1], edge.motion[2]}; }

}  // namespace

Placement placement_of(const PoseGraph& graph) {
  Placement at;
  at.reserve(graph.vertices.size());
  for (const GraphVertex& vertex : graph.vertices) at.push_back({vertex.x, vertex.y, vertex.yaw});
  return at;
}

Eigen::Vector3d edge_error(const GraphEdge& edge, const Placement& at) {
  const math::Pose error = between(measured(edge), between(at[edge.from], at[edge.to]));
  return {error.x, error.y, math::wrap_angle(error.yaw)};
}

Eigen::Matrix3d information_of(const GraphEdge& edge) {
  const auto& [xx, xy, xt, yy, yt, tt] = edge.information;
  Eigen::Matrix3d matrix;
  matrix << xx, xy, xt, xy, yy, yt, xt, yt, tt;
  return matrix;
}

// With Q = R(yaw_from + yaw_Z)^T the error is Q (t_to - t_from) - R_Z^T t_Z. The translation of Z is a
// constant: it does not enter the derivatives.
EdgeJacobians edge_jacobians(const GraphEdge& edge, const Placement& at) {
  const math::Pose& from = at[edge.from];
  const math::Pose& to = at[edge.to];
  const double c = std::cos(from.yaw + edge.motion[2]);
  const double s = std::sin(from.yaw + edge.motion[2]);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  EdgeJacobians jacobians;
  jacobians.to << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  jacobians.from << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0.0, 0.0, -1.0;
  return jacobians;
}

double chi2(const GraphEdge& edge, const Placement& at) {
  const Eigen::Vector3d error = edge_error(edge, at);
  return error.dot(information_of(edge) * error);
}

double chi2(const PoseGraph& graph, const Placement& at) {
  double sum = 0.0;
  for (const GraphEdge& edge : graph.edges) sum += chi2(edge, at);
  return sum;
}

}  // namespace odomcalib::calib::slam
