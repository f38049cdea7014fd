// One run of the pose graph optimiser as the command line does it, and the reports about graphs.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "calib/slam/info.hpp"
#include "calib/slam/optimize.hpp"
#include "calib/slam/recording_map.hpp"
#include "daemon/cli/document.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::cli {

const std::map<std::string, calib::slam::GraphStart>& graph_starts();
const std::map<std::string, calib::slam::GraphMethod>& graph_methods();
/// "converged", "not_connected" and so on, as in the enumeration.
std::string state_name(calib::slam::GraphState state);

struct TimedIteration {
  calib::slam::GraphIteration iteration;
  std::int64_t time_us = 0;  ///< since the begin of the run
};

struct GraphRun {
  PoseGraph before;
  PoseGraph after;
  calib::slam::GraphSummary summary;
  std::vector<TimedIteration> iterations;  ///< of all first guesses that were tried
  std::vector<std::int64_t> fixed;         ///< ids
  std::int64_t time_us = 0;
};

/// Fixes the first pose for the time of the run if the graph fixes none, places the vertices along the
/// odometry if the graph has none, and notes both.
GraphRun run_graph(PoseGraph graph, const calib::slam::GraphOptions& options,
                   const calib::slam::GraphObserver& observer = {});

nlohmann::ordered_json to_json(const GraphRun& run);
Document describe(const GraphRun& run);

nlohmann::ordered_json to_json(const PoseGraph& graph, const calib::slam::GraphInfo& info);
Document describe(const PoseGraph& graph, const calib::slam::GraphInfo& info);

nlohmann::ordered_json to_json(const calib::slam::RecordingMap& map);
Document describe(const calib::slam::RecordingMap& map);

}  // namespace odomcalib::cli
