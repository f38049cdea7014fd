// Least squares over a planar pose graph: the poses and points that agree best with all measured motions.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "calib/slam/settings.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

enum class GraphStart {
  automatic,  ///< rotations first; the file's own values too where they may lead further down
  file,       ///< the vertices as they are
  odometry,   ///< edges between neighbouring ids, chained
  tree,       ///< a breadth-first spanning tree
  rotations,  ///< headings from all edges at once, then positions (calib/graph/first_guess.hpp)
};

enum class GraphMethod {
  automatic,            ///< Gauss-Newton; Levenberg-Marquardt where that leads nowhere
  gauss_newton,         ///< full steps only
  levenberg_marquardt,  ///< never accepts a step that raises chi2
};

/// How a run ended. Only `converged` says that chi2 is a minimum, and none that it is the global one.
enum class GraphState {
  not_run,
  converged,
  stalled,          ///< no step lowers chi2 further, though the slope is not zero
  iteration_limit,  ///< still falling when the iterations ran out
  no_gauge,         ///< nothing is fixed: the whole graph could be moved without a change of chi2
  not_connected,    ///< a part of the graph does not hang together with a fixed vertex
  singular,         ///< the edges leave a vertex undetermined
  not_finite,       ///< numbers too large to compute with
};

struct GraphOptions {
  /// Tried first. Others follow where the result looks like a false minimum, unless a method is named too.
  GraphStart start = GraphStart::automatic;
  GraphMethod method = GraphMethod::automatic;
  int max_iterations = settings::kMostIterations;
  double tolerance = settings::kGraphTolerance;  ///< of chi2, relative: what may be left to gain
};

struct GraphIteration {
  double chi2 = 0.0;    ///< after the step
  double step = 0.0;    ///< largest change of a coordinate, m or rad
  double lambda = 0.0;  ///< damping; 0: Gauss-Newton
  bool accepted = true;
};

struct GraphSummary {
  GraphState state = GraphState::not_run;
  std::string reason;  ///< of every state but converged: what, which vertex, what to do next
  GraphStart start = GraphStart::automatic;  ///< that led to the result
  double chi2_before = -1.0;                 ///< at the vertices as given
  double chi2_start = -1.0;                  ///< at the first guess
  double chi2_after = -1.0;
  std::size_t measured = 0;  ///< numbers that the edges measure
  std::size_t unknowns = 0;  ///< coordinates that were free; chi2 expects measured - unknowns
  std::vector<GraphIteration> iterations;
  std::vector<std::string> notes;  ///< what the reader of the result should know

  /// The vertices were updated, and no better ones were in reach.
  [[nodiscard]] bool is_usable() const {
    return state == GraphState::converged || state == GraphState::stalled;
  }
};

/// Fixes the first pose if nothing is fixed: which one does not matter for chi2, only for where the map lies.
/// @return position of that vertex, or vertices.size() if nothing had to be fixed
std::size_t fix_first_pose(PoseGraph& graph);

/// For files that hold edges only: chains the motions from the fixed poses, neighbouring ids first. They
/// remain a guess: has_positions stays false.
void place_along_odometry(PoseGraph& graph);

using GraphObserver = std::function<void(const GraphIteration&)>;

/// Moves the vertices that are not fixed. On a state that is no result the graph is left as it was.
GraphSummary optimize_graph(PoseGraph& graph, const GraphOptions& options = {},
                            const GraphObserver& observer = {});

/// Sum of e' I e over all edges at the vertices as they are (g2o's convention, without a factor 1/2).
double graph_chi2(const PoseGraph& graph);

/// Settles the graph and lowers the information of edges that the others contradict, again and again: weights
/// of Cauchy's distribution, 1 / (1 + chi2 / c^2) (Huber, Robust Statistics, 1981, chapter 7). What the edges
/// hold afterwards is what they were trusted, so that settling the graph again moves nothing.
/// @return whether the graph could be settled; if not, it is as it was
bool settle_robustly(PoseGraph& graph);

}  // namespace odomcalib::calib::slam
