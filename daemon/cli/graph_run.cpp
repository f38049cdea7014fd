#include "daemon/cli/graph_run.hpp"

#include <chrono>

namespace odomcalib::cli {
namespace {

using RunClock = std::chrono::steady_clock;

std::int64_t microseconds_since(RunClock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::microseconds>(RunClock::now() - begin).count();
}

}  // namespace

const std::map<std::string, calib::slam::GraphStart>& graph_starts() {
  using calib::slam::GraphStart;
  static const std::map<std::string, GraphStart> kStarts{{"auto", GraphStart::automatic},
                                                         {"file", GraphStart::file},
                                                         {"odometry", GraphStart::odometry},
                                                         {"tree", GraphStart::tree},
                                                         {"rotations", GraphStart::rotations}};
  return kStarts;
}

const std::map<std::string, calib::slam::GraphMethod>& graph_methods() {
  using calib::slam::GraphMethod;
  static const std::map<std::string, GraphMethod> kMethods{
      {"auto", GraphMethod::automatic},
      {"gauss-newton", GraphMethod::gauss_newton},
      {"levenberg-marquardt", GraphMethod::levenberg_marquardt}};
  return kMethods;
}

std::string state_name(calib::slam::GraphState state) {
  using calib::slam::GraphState;
  switch (state) {
    case GraphState::not_run:
      return "not_run";
    case GraphState::converged:
      return "converged";
    case GraphState::stalled:
      return "stalled";
    case GraphState::iteration_limit:
      return "iteration_limit";
    case GraphState::no_gauge:
      return "no_gauge";
    case GraphState::not_connected:
      return "not_connected";
    case GraphState::singular:
      return "singular";
    case GraphState::not_finite:
      return "not_finite";
  }
  return "";
}

GraphRun run_graph(PoseGraph graph, const calib::slam::GraphOptions& options,
                   const calib::slam::GraphObserver& observer) {
  GraphRun run;
  std::vector<std::string> notes = graph.notes;
  const std::size_t anchor = calib::slam::fix_first_pose(graph);
  const bool anchored = anchor < graph.vertices.size();
  if (anchored)
    notes.push_back("nothing is fixed in the file: pose " + std::to_string(graph.vertices[anchor].id) +
                    " is kept where it is");
  if (!graph.has_positions) {
    calib::slam::place_along_odometry(graph);
    notes.emplace_back("the file holds edges only: \"before\" is dead reckoning along them");
  }
  for (const GraphVertex& vertex : graph.vertices)
    if (vertex.fixed) run.fixed.push_back(vertex.id);
  run.before = graph;
  const auto begin = RunClock::now();
  run.summary = calib::slam::optimize_graph(
      graph, options, [&run, &observer, begin](const calib::slam::GraphIteration& iteration) {
        run.iterations.push_back({iteration, microseconds_since(begin)});
        if (observer) observer(iteration);
      });
  run.time_us = microseconds_since(begin);
  run.summary.notes.insert(run.summary.notes.begin(), notes.begin(), notes.end());
  if (anchored) graph.vertices[anchor].fixed = false;
  run.after = std::move(graph);
  return run;
}

}  // namespace odomcalib::cli
