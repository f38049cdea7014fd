#include "daemon/cli/graph_map.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/slam/info.hpp"

namespace odomcalib::cli {
namespace {

using calib::slam::EdgeSource;
using nlohmann::ordered_json;

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
