// From a first guess down to a minimum of chi2.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/slam/block_matrix.hpp"
#include "calib/slam/edge_error.hpp"
#include "calib/slam/optimize.hpp"

namespace odomcalib::calib::slam {

/// Coordinates that may move.
enum class Freedom {
  poses,      ///< positions and headings
  positions,  ///< headings are taken as known: the error is linear, one step is the answer
};

/// Blocks of the graph's matrices that are not zero, one per edge.
std::vector<BlockLink> links_of(const PoseGraph& graph);

/// The linear system of one Gauss-Newton step over a graph: H dx = -J' I e (Grisetti et al. 2010, eq. 15).
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

struct Descent {
  GraphState state = GraphState::not_run;
  Placement at;  ///< the lowest that was seen
  double chi2 = 0.0;
  double chi2_start = 0.0;
  std::vector<GraphIteration> iterations;
  std::optional<std::size_t> undetermined;  ///< vertex, for GraphState::singular
};

/// `automatic` is Gauss-Newton with a backtracking line search on the separable problem (Khosoussi et al.
/// 2015, "Exploiting the separable structure of SLAM"): given the headings, the best positions follow from
/// one linear solve. Where a step falls short of what the linear model promised, the positions are therefore
/// solved for its headings before it is judged. A turned heading moves everything behind it on an arc; the
/// straight tangent step leaves chi2 as high as before, and damping it (Levenberg-Marquardt) crawls along the
/// arc for hundreds of steps when the information is anisotropic. This does neither.
Descent descend(const PoseGraph& graph, const std::vector<std::size_t>& places, Placement start,
                const GraphOptions& options, const GraphObserver& observer);

/// The best positions for the headings of `at`: the error is linear in them.
class PositionSolver {
 public:
  PositionSolver(const PoseGraph& graph, const std::vector<std::size_t>& places)
      : equations_(graph, places, Freedom::positions) {}
  /// `at` itself where the edges do not determine all positions.
  Placement solve(const Placement& at);

 private:
  NormalEquations equations_;
};

}  // namespace odomcalib::calib::slam
