#include "calib/slam/recording_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/matching/probability_grid.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/scan_surfaces.hpp"
#include "calib/slam/settings.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::slam {
namespace {

/// Scans of the first sensor during which the wheels are known, with the lidar's pose by odometry.
struct Instants {
  std::vector<std::size_t> scans;
  std::vector<math::Pose> poses;
};

Instants instants_of(const Recording& recording, const measurement::ScanSurfaces& surfaces,
                     const wheels::WheelTrack& track, const math::Pose& mount) {
  Instants found;
  for (std::size_t k = 0; k < recording.scans.size(); ++k) {
    const double t = surfaces.times()[k];
    if (recording.scans[k].sensor != recording.scans.front().sensor || !track.covers(t, t)) continue;
    found.scans.push_back(k);
    found.poses.push_back(compose(surfaces.odometry()[k], mount));
  }
  return found;
}

Instants keyframes_of(const Instants& all, const KeyframeSpacing& spacing) {
  Instants chosen;
  for (const std::size_t k : choose_keyframes(all.poses, spacing)) {
    chosen.scans.push_back(all.scans[k]);
    chosen.poses.push_back(all.poses[k]);
  }
  return chosen;
}

/// The vertices of a graph at other poses, relative to the first.
PoseGraph placed_at(PoseGraph graph, const std::vector<math::Pose>& poses) {
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const math::Pose pose = between(poses.front(), poses[k]);
    graph.vertices[k].x = pose.x;
    graph.vertices[k].y = pose.y;
    graph.vertices[k].yaw = math::wrap_angle(pose.yaw);
  }
  return graph;
}

math::Pose pose_of(const GraphVertex& vertex) { return {vertex.x, vertex.y, vertex.yaw}; }

std::vector<Eigen::Vector2d> seen_from(const GraphVertex& vertex, const matching::Surface& surface) {
  std::vector<Eigen::Vector2d> seen;
  const math::Frame frame(pose_of(vertex));
  for (const matching::SurfacePoint& point : surface.points) seen.push_back(frame.transform(point.position));
  return seen;
}

std::vector<Eigen::Vector2d> seen_in_map(const std::vector<matching::Surface>& surfaces,
                                         const PoseGraph& graph) {
  std::vector<Eigen::Vector2d> seen;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const auto here = seen_from(graph.vertices[k], surfaces[k]);
    seen.insert(seen.end(), here.begin(), here.end());
  }
  std::erase_if(seen,
                [](const auto& p) { return !(p.cwiseAbs().maxCoeff() < settings::kFarthestReading_m); });
  return seen;
}

matching::GridOptions grid_about(const std::vector<Eigen::Vector2d>& seen) {
  double half_size = settings::kFinestCell_m;
  for (const Eigen::Vector2d& p : seen)
    half_size = std::max(half_size, p.cwiseAbs().maxCoeff() + settings::kFinestCell_m);
  return {.cell = std::max(settings::kFinestCell_m, half_size / settings::kMostCells),
          .half_size = half_size};
}

/// Centres of the cells in which something was seen, each once.
std::vector<Eigen::Vector2d> cells_seen(const std::vector<Eigen::Vector2d>& seen, double cell) {
  std::vector<std::pair<double, double>> cells;
  cells.reserve(seen.size());
  for (const Eigen::Vector2d& p : seen)
    cells.emplace_back(std::floor(p.x() / cell), std::floor(p.y() / cell));
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<Eigen::Vector2d> centres;
  centres.reserve(cells.size());
  for (const auto& [x, y] : cells) centres.emplace_back((x + 0.5) * cell, (y + 0.5) * cell);
  return centres;
}

void draw_map(const std::vector<matching::Surface>& surfaces, RecordingMap& map) {
  const auto seen = seen_in_map(surfaces, map.made.graph);
  const matching::GridOptions options = grid_about(seen);
  matching::ProbabilityGrid grid(options);
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    grid.insert(pose_of(map.made.graph.vertices[k]), positions(surfaces[k]));
  map.cell = options.cell;
  map.last_scan = seen_from(map.made.graph.vertices[surfaces.size() - 1], surfaces.back());
  map.occupied = cells_seen(seen, options.cell);
  std::erase_if(map.occupied,
                [&grid](const auto& centre) { return grid.probability(centre) < settings::kOccupied; });
}

}  // namespace

Result<RecordingMap> map_recording(const Recording& recording, ScanGraphOptions options) {
  const RobotDescription& robot = recording.robot;
  if (!(robot.ticks_per_rev > 0.0 && robot.left_wheel_diameter > 0.0 && robot.right_wheel_diameter > 0.0 &&
        robot.track_width > 0.0))
    return Error{ErrorCode::missing_units, "the robot's dimensions are missing", recording.name,
                 "add them to the robot line or name a robot file"};
  const wheels::WheelTrack track = wheels::wheel_track_from_ticks(recording);
  if (track.empty())
    return Error{ErrorCode::empty, "no tick samples", recording.name, "a map begins with odometry"};
  if (recording.scans.empty()) return Error{ErrorCode::empty, "no scans", recording.name, ""};
  const wheels::BaseParameters nominal = wheels::nominal_base(robot);
  const vehicle::DriveModel model(track, vehicle::make_context(track, nominal, {}));
  const Eigen::VectorXd parameters = vehicle::to_vector(nominal);
  RecordingMap map;
  map.range_noise = options.loop.range_noise = matching::estimate_range_noise(recording.scans);
  const measurement::ScanSurfaces scans(recording, model, vehicle::as_span(parameters), {}, map.range_noise);
  const Instants keyframes =
      keyframes_of(instants_of(recording, scans, track, nominal.mount), options.spacing);
  if (keyframes.scans.size() < 2)
    return Error{ErrorCode::empty, "fewer than two keyframes", recording.name,
                 "the robot has to move while scans and ticks are recorded"};
  std::vector<matching::Surface> surfaces;
  for (const std::size_t scan : keyframes.scans) surfaces.push_back(scans.surface(scan));
  options.spacing = {0.0, 0.0};  // they are chosen already
  map.made = build_scan_graph(surfaces, keyframes.poses, options);
  map.made.scans = keyframes.scans;
  map.by_odometry = placed_at(map.made.graph, keyframes.poses);
  draw_map(surfaces, map);
  return map;
}

}  // namespace odomcalib::calib::slam
