// Terms of one edge for its two vertices: error, weight, derivatives.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

/// Where every vertex of a PoseGraph is, in its order. Points use x and y only.
using Placement = std::vector<math::Pose>;

Placement placement_of(const PoseGraph& graph);

/// e = t2v(Z^-1 (Xi^-1 Xj)) in the frame of the measurement: x, y [m], yaw [rad] in (-pi, pi]
/// (Grisetti et al. 2010, "A tutorial on graph-based SLAM", eq. 30). For a point, Z has no rotation and the
/// third component is without weight.
Eigen::Vector3d edge_error(const GraphEdge& edge, const Placement& at);

/// The edge's information as a symmetric matrix, [1/m^2, 1/(m rad), 1/rad^2].
Eigen::Matrix3d information_of(const GraphEdge& edge);

struct EdgeJacobians {
  Eigen::Matrix3d from;  ///< de / d(x, y, yaw) of vertex `from`
  Eigen::Matrix3d to;    ///< de / d(x, y, yaw) of vertex `to`
};

EdgeJacobians edge_jacobians(const GraphEdge& edge, const Placement& at);

/// e' I e of one edge, and the sum over all edges: the convention of g2o, without a factor 1/2.
double chi2(const GraphEdge& edge, const Placement& at);
double chi2(const PoseGraph& graph, const Placement& at);

}  // namespace odomcalib::calib::slam
