// Reports about pose graphs, as text and as JSON.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/cli/graph_run.hpp"

namespace odomcalib::cli {
namespace {

using calib::slam::EdgeSource;
using nlohmann::ordered_json;

std::int64_t degrees_of_freedom(const calib::slam::GraphSummary& summary) {
  return static_cast<std::int64_t>(summary.measured) - static_cast<std::int64_t>(summary.unknowns);
}

std::string start_name(calib::slam::GraphStart start) {
  for (const auto& [name, named] : graph_starts())
    if (named == start) return name;
  return "";
}

Section iteration_log(const std::vector<TimedIteration>& iterations) {
  Section log{"Iterations", {}, {{"", "chi2", "largest move", "lambda", "ms"}, {}}};
  for (std::size_t i = 0; i < iterations.size(); ++i) {
    const auto& [iteration, time_us] = iterations[i];
    log.table.rows.push_back({fmt::format("{}{}", i + 1, iteration.accepted ? "" : " (refused)"),
                              fmt::format("{:.6f}", iteration.chi2), fmt::format("{:.3g}", iteration.step),
                              fmt::format("{:.3g}", iteration.lambda),
                              fmt::format("{:.1f}", 1e-3 * static_cast<double>(time_us))});
  }
  return log;
}

ordered_json worst_edges(const PoseGraph& graph, const calib::slam::GraphInfo& info) {
  ordered_json edges = ordered_json::array();
  for (const calib::slam::WorstEdge& worst : info.worst_edges) {
    const GraphEdge& edge = graph.edges[worst.edge];
    edges.push_back(
        {{"from", graph.vertices[edge.from].id}, {"to", graph.vertices[edge.to].id}, {"chi2", worst.chi2}});
  }
  return edges;
}

/// Where the last keyframe lies after settling, compared with odometry, m.
double correction_at_the_end(const calib::slam::RecordingMap& map) {
  const GraphVertex &by_odometry = map.by_odometry.vertices.back(), &settled = map.made.graph.vertices.back();
  return std::hypot(settled.x - by_odometry.x, settled.y - by_odometry.y);
}

Section refusals(const calib::slam::ScanGraph& made) {
  Section section{"Places compared and not tied", {}, {{"why", "count"}, {}}};
  for (const auto& [reason, count] : made.refused)
    section.table.rows.push_back({reason, std::to_string(count)});
  return section;
}

}  // namespace

ordered_json to_json(const GraphRun& run) {
  ordered_json iterations = ordered_json::array();
  for (const auto& [iteration, time_us] : run.iterations)
    iterations.push_back({{"chi2", iteration.chi2},
                          {"step", iteration.step},
                          {"lambda", iteration.lambda},
                          {"accepted", iteration.accepted},
                          {"time_us", time_us}});
  return {{"state", state_name(run.summary.state)},
          {"chi2_before", run.summary.chi2_before},
          {"chi2_start", run.summary.chi2_start},
          {"chi2_after", run.summary.chi2_after},
          {"degrees_of_freedom", degrees_of_freedom(run.summary)},
          {"start", start_name(run.summary.start)},
          {"vertices", run.after.vertices.size()},
          {"edges", run.after.edges.size()},
          {"fixed", run.fixed},
          {"iterations", std::move(iterations)},
          {"time_us", run.time_us},
          {"notes", run.summary.notes}};
}

Document describe(const GraphRun& run) {
  const calib::slam::GraphSummary& summary = run.summary;
  Section about{
      "",
      {fmt::format("{} vertices, {} edges; chi2 of about {} would agree with the stated information",
                   run.after.vertices.size(), run.after.edges.size(), degrees_of_freedom(summary)),
       fmt::format("first guess: {}, chi2 {:.6f}", start_name(summary.start), summary.chi2_start)},
      {}};
  if (!summary.reason.empty()) about.lines.push_back(summary.reason);
  about.lines.insert(about.lines.end(), summary.notes.begin(), summary.notes.end());
  return {fmt::format("chi2 {:.6f} before, {:.6f} after: {}", summary.chi2_before, summary.chi2_after,
                      state_name(summary.state)),
          {std::move(about), iteration_log(run.iterations)}};
}

ordered_json to_json(const PoseGraph& graph, const calib::slam::GraphInfo& info) {
  return {{"poses", info.poses},
          {"points", info.points},
          {"pose_edges", info.pose_edges},
          {"point_edges", info.point_edges},
          {"fixed", info.fixed},
          {"parts", info.parts},
          {"loops", info.loops},
          {"turned_loops", info.turned_loops},
          {"path_length", info.path_length},
          {"chi2", info.chi2},
          {"worst_edges", worst_edges(graph, info)},
          {"notes", graph.notes}};
}

Document describe(const PoseGraph& graph, const calib::slam::GraphInfo& info) {
  Section about{"", graph.notes, {}};
  about.lines.push_back(fmt::format("{} poses, {} points, {} fixed, {} connected {}", info.poses, info.points,
                                    info.fixed, info.parts, info.parts == 1 ? "part" : "parts"));
  about.lines.push_back(fmt::format("{} edges between poses, {} to points; {} loops; {:.1f} m of path",
                                    info.pose_edges, info.point_edges, info.loops, info.path_length));
  if (info.turned_loops > 0)
    about.lines.push_back(
        fmt::format("{} loops have a whole turn too much in them: optimise the graph", info.turned_loops));
  Section worst{"Edges with the largest share of chi2", {}, {{"from", "to", "chi2"}, {}}};
  for (const calib::slam::WorstEdge& edge : info.worst_edges)
    worst.table.rows.push_back({std::to_string(graph.vertices[graph.edges[edge.edge].from].id),
                                std::to_string(graph.vertices[graph.edges[edge.edge].to].id),
                                fmt::format("{:.6f}", edge.chi2)});
  return {fmt::format("chi2 {:.6f}", info.chi2), {std::move(about), std::move(worst)}};
}

ordered_json to_json(const calib::slam::RecordingMap& map) {
  const calib::slam::GraphInfo info = calib::slam::inspect_graph(map.made.graph);
  ordered_json refused = ordered_json::object();
  for (const auto& [reason, count] : map.made.refused) refused[reason] = count;
  return {{"keyframes", info.poses},
          {"steps_matched", map.made.count(EdgeSource::match)},
          {"steps_by_odometry", map.made.count(EdgeSource::odometry)},
          {"loops", map.made.count(EdgeSource::loop)},
          {"refused", std::move(refused)},
          {"chi2", info.chi2},
          {"path_length", info.path_length},
          {"correction_at_the_end", correction_at_the_end(map)},
          {"range_noise", map.range_noise},
          {"cell", map.cell},
          {"occupied_cells", map.occupied.size()}};
}

Document describe(const calib::slam::RecordingMap& map) {
  const calib::slam::GraphInfo info = calib::slam::inspect_graph(map.made.graph);
  const Section about{"",
                      {fmt::format("{} steps between keyframes matched, {} by odometry alone",
                                   map.made.count(EdgeSource::match), map.made.count(EdgeSource::odometry)),
                       fmt::format("{:.1f} m of path; the end lies {:.3f} m from where odometry puts it",
                                   info.path_length, correction_at_the_end(map)),
                       fmt::format("chi2 {:.6f}; range noise {:.1f} mm", info.chi2, 1e3 * map.range_noise),
                       fmt::format("{} cells of {:.2f} m are occupied", map.occupied.size(), map.cell)},
                      {}};
  return {fmt::format("{} keyframes, {} loops closed", info.poses, map.made.count(EdgeSource::loop)),
          {about, refusals(map.made)}};
}

}  // namespace odomcalib::cli
