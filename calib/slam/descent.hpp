// From a first guess down to a minimum of chi2.
#pragma once

#include <optional>

#include "calib/slam/normal_equations.hpp"
#include "calib/slam/optimize.hpp"

namespace odomcalib::calib::slam {

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
