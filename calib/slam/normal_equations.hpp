// The linear system of one Gauss-Newton step over a graph: H dx = -J' I e (Grisetti et al. 2010, eq. 15).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/slam/block_matrix.hpp"
#include "calib/slam/edge_error.hpp"

namespace odomcalib::calib::slam {

/// Coordinates that may move.
enum class Freedom {
  poses,      ///< positions and headings
  positions,  ///< headings are taken as known: the error is linear, one step is the answer
};

/// Blocks of the graph's matrices that are not zero, one per edge.
std::vector<BlockLink> links_of(const PoseGraph& graph);

class NormalEquations {
 public:
  /// @param places order of elimination (elimination_places), which depends on the edges only
  NormalEquations(const PoseGraph& graph, const std::vector<std::size_t>& places, Freedom freedom);

  /// Sums H and the right-hand side at `at`.
  /// @return chi2 there
  double linearize(const Placement& at);
  /// Factorises H + lambda diag(H).
  /// @return position of a vertex that the edges do not determine, if there is one
  std::optional<std::size_t> factorize(double lambda);
  /// The step for the factorised matrix; rows as in move().
  [[nodiscard]] Eigen::VectorXd solve() const { return hessian_.solve(right_side_); }
  /// Fall of chi2 on a step of the matrix H + lambda diag(H), by the linear model.
  [[nodiscard]] double predicted_fall(const Eigen::VectorXd& step, double lambda) const;
  /// x, y and yaw are added: the tangent space is that of the vertex' own x, y, yaw in the map.
  [[nodiscard]] Placement move(const Placement& at, const Eigen::VectorXd& step) const;

  [[nodiscard]] Eigen::Index unknowns() const { return hessian_.rows(); }

 private:
  void add_edge(std::size_t k, const Placement& at, const Eigen::Vector3d& error);

  const PoseGraph& graph_;
  BlockMatrix<double> hessian_;
  std::vector<BlockMatrix<double>::Slot> slots_;  // per edge
  Eigen::VectorXd right_side_;
};

}  // namespace odomcalib::calib::slam
