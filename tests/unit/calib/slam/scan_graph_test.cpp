// Drives through a floor of alike rooms: every place seen again must be itself.
#include "calib/slam/scan_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "calib/math/median.hpp"
#include "proto/file_bytes.hpp"
#include "tests/unit/calib/room_scans.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::calib::slam::scan_graph_test {
namespace {

const matching::BeamMotion kAtRest = [](double) { return math::Pose{}; };
constexpr double kNoise = 0.01;

TEST(Keyframes, S2_22_one_after_each_half_metre_or_half_radian) {
  std::vector<math::Pose> straight, spin;
  for (int k = 0; k <= 1000; ++k) {
    straight.push_back({0.01 * k, 0.0, 0.0});  // 10 m
    spin.push_back({0.0, 0.0, 0.02 * k});      // 20 rad
  }
  EXPECT_NEAR(static_cast<double>(choose_keyframes(straight, {}).size()), 21.0, 1.0);
  EXPECT_NEAR(static_cast<double>(choose_keyframes(spin, {}).size()), 41.0, 1.0);
  EXPECT_TRUE(choose_keyframes({}, {}).empty());
}

/// Steps of up to a metre and half a turn, as wheels that are 4 % large and turn 0.06 rad a metre see them.
math::Pose step_with(std::mt19937& engine, double noise, math::Pose& odometry) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise);
  odometry = {uniform(engine), 0.02 * uniform(engine), 2.0 * (uniform(engine) - 0.5)};
  return {0.96 * odometry.x + normal(engine), odometry.y + 0.08 * odometry.yaw + normal(engine),
          odometry.yaw + 0.06 * odometry.x + normal(engine)};
}

TEST(OdometryCorrection, what_is_always_wrong_is_learnt_and_what_is_left_is_stated) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 engine(seed);
    OdometryCorrection correction(0.1);
    math::Pose odometry;
    for (int k = 0; k < 60; ++k) {
      const math::Pose measured = step_with(engine, 0.015, odometry);
      correction.learn(odometry,
                       k % 10 == 9 ? math::Pose{5.0, -3.0, 1.0} : measured);  // every tenth match is false
    }
    const math::Pose truth = step_with(engine, 0.0, odometry), found = correction.corrected(odometry);
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.02) << "seed " << seed;
    EXPECT_NEAR(found.yaw, truth.yaw, 0.02) << "seed " << seed;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(correction.sigma()(i), 0.01) << "seed " << seed;
      EXPECT_LT(correction.sigma()(i), 0.05) << "seed " << seed;
    }
  }
}

TEST(OdometryCorrection, with_nothing_learnt_odometry_stands) {
  const math::Pose same = OdometryCorrection(0.1).corrected({0.5, -0.1, 0.3});
  EXPECT_EQ(same.x, 0.5);
  EXPECT_EQ(same.y, -0.1);
  EXPECT_EQ(same.yaw, 0.3);
}

/// A ring of corridors about a block, with a niche that differs at each corner and two rooms that are the
/// same.
std::vector<test_support::RoomWall> floor_plan() {
  std::vector<test_support::RoomWall> walls = {
      {-5, -4, 5, -4},     {5, -4, 5, 4},          {5, 4, -5, 4},          {-5, 4, -5, -4},
      {-3, -2, 3, -2},     {3, -2, 3, 2},          {3, 2, -3, 2},          {-3, 2, -3, -2},
      {-5, -3, -4.6, -3},  {-4.6, -3, -4.6, -2.2}, {-4.6, -2.2, -5, -2.2}, {4, -4, 4, -3.7},
      {4, -3.7, 4.8, -3.7}};
  for (const double x : {-1.5, 1.5})  // the same twice: what tempts to a false loop
    for (const auto& w : {test_support::RoomWall{x - 0.3, 4, x - 0.3, 3.6},
                          {x - 0.3, 3.6, x + 0.3, 3.6},
                          {x + 0.3, 3.6, x + 0.3, 4}})
      walls.push_back(w);
  return walls;
}

struct Tour {
  std::vector<math::Pose> truth, odometry;
  std::vector<matching::Surface> surfaces;
};

/// Once and a half round the block, with odometry that is off by up to 3 % and 2 degrees a metre.
Tour make_tour(unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto walls = floor_plan();
  const std::vector<Eigen::Vector2d> corners = {{-4, -3}, {4, -3}, {4, 3}, {-4, 3}};
  const double scale = 1.0 + 0.03 * uniform(engine), bend = 0.035 * uniform(engine);
  Tour tour;
  math::Pose believed;
  for (int side = 0; side < 6; ++side) {
    const Eigen::Vector2d& from = corners[static_cast<std::size_t>(side % 4)];
    const Eigen::Vector2d way = corners[static_cast<std::size_t>((side + 1) % 4)] - from;
    const int steps = static_cast<int>(way.norm() / 0.5);
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d at = from + way * i / steps;
      const math::Pose pose{at.x() + 0.1 * normal(engine), at.y() + 0.1 * normal(engine),
                            std::atan2(way.y(), way.x()) + 0.05 * normal(engine)};
      if (!tour.truth.empty()) {
        math::Pose step = between(tour.truth.back(), pose);
        const double length = std::hypot(step.x, step.y);
        step = {scale * step.x, scale * step.y,
                math::wrap_angle(step.yaw) + bend * length + 0.01 * normal(engine)};
        believed = compose(believed, step);
      }
      tour.truth.push_back(pose);
      tour.odometry.push_back(believed);
      const auto scan = test_support::scan_from(walls, pose, kNoise,
                                                seed * 1000 + static_cast<unsigned>(tour.truth.size()));
      tour.surfaces.push_back(matching::make_surface(scan, kAtRest, kNoise));
    }
  }
  return tour;
}

TEST(ScanGraph, S2_24_in_a_hundred_tours_every_loop_is_true_and_every_tour_is_closed) {
  constexpr unsigned kRuns = 100;
  std::size_t loops = 0, false_loops = 0, open_tours = 0;
  double before = 0.0, after = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Tour tour = make_tour(seed);
    const ScanGraph made = build_scan_graph(tour.surfaces, tour.odometry, {});
    for (std::size_t e = 0; e < made.graph.edges.size(); ++e) {
      if (made.sources[e] != EdgeSource::loop) continue;
      const GraphEdge& edge = made.graph.edges[e];
      const math::Pose truth = between(tour.truth[made.scans[edge.from]], tour.truth[made.scans[edge.to]]);
      const bool good = std::hypot(edge.motion[0] - truth.x, edge.motion[1] - truth.y) < 0.1 &&
                        std::abs(math::wrap_angle(edge.motion[2] - truth.yaw)) < 0.03;
      ++loops;
      if (good) continue;
      ++false_loops;
      ADD_FAILURE() << "seed " << seed << ": false loop from keyframe " << edge.from << " to " << edge.to;
    }
    if (made.count(EdgeSource::loop) == 0) ++open_tours;
    const auto end_error = [&](const math::Pose& end) {
      const math::Pose truth = between(tour.truth.front(), tour.truth[made.scans.back()]);
      return std::hypot(end.x - truth.x, end.y - truth.y);
    };
    const GraphVertex& last = made.graph.vertices.back();
    before += end_error(tour.odometry[made.scans.back()]) / kRuns;
    after += end_error({last.x, last.y, last.yaw}) / kRuns;
  }
  std::printf(
      "%zu loops, %zu false, %zu tours without; mean error at the end %.3f m by odometry, %.3f m in the "
      "graph\n",
      loops, false_loops, open_tours, before, after);
  EXPECT_EQ(open_tours, 0U);
  EXPECT_LT(after, 0.1 * before);
}

struct Log {
  std::vector<Scan> scans;
  std::vector<math::Pose> odometry;
};

Log read_intel() {
  Log log;
  const auto bytes = read_file_bytes(test_support::shared_data("scanmatch/intel.jsonl.gz"));
  if (!bytes) return log;
  std::istringstream in(gunzip(bytes.value()).bytes);
  std::string line;
  std::getline(in, line);
  const auto head = nlohmann::json::parse(line);
  while (std::getline(in, line)) {
    const auto record = nlohmann::json::parse(line);
    Scan scan;
    scan.t = record["t"];
    scan.angle_min = head["angle_min"];
    scan.angle_increment = head["angle_inc"];
    scan.range_max = head["range_max"];
    for (const auto& range : record["r"]) scan.ranges.push_back(range.get<float>());
    log.scans.push_back(scan);
    log.odometry.push_back({record["odom"][0], record["odom"][1], record["odom"][2]});
  }
  return log;
}

// Relations checked by a person. Of the matchers compared on these pairs from guesses within 10 cm and 5
// degrees, csm comes within 60 mm and 1 degree of 84 % of them with medians of 10.6 mm and 0.18 degrees. Here
// the guess is the log's odometry and the pose that of the graph: 82 %, 10.4 mm, 0.17 degrees were measured.
// Ten relations are off by more than a degree themselves: single matches, the graph and the poses published
// with the log agree there.
TEST(ScanGraph, S2_24_the_intel_lab_closes_and_agrees_with_the_relations_checked_by_hand) {
  ODOMCALIB_NEEDS_SHARED("scanmatch");
  const Log log = read_intel();
  ASSERT_EQ(log.scans.size(), 910U);
  const double noise = matching::estimate_range_noise(log.scans);
  std::vector<matching::Surface> surfaces;
  for (const Scan& scan : log.scans) surfaces.push_back(matching::make_surface(scan, kAtRest, noise));
  ScanGraphOptions options;
  options.spacing = {0.0, 0.0};  // the log holds keyframes only
  options.loop.range_noise = noise;
  const ScanGraph made = build_scan_graph(surfaces, log.odometry, options);
  std::vector<double> distances, angles;
  std::size_t pairs = 0;
  double farthest = 0.0;
  std::istringstream relations(
      read_file_bytes(test_support::shared_data("scanmatch/intel.relations.txt")).value());
  for (std::string line; std::getline(relations, line);) {
    std::istringstream fields(line);
    std::size_t i = 0, j = 0;
    math::Pose relation;
    if (!(fields >> i >> j >> relation.x >> relation.y >> relation.yaw)) continue;
    const GraphVertex &a = made.graph.vertices[i], &b = made.graph.vertices[j];
    const math::Pose error =
        between(relation, between(math::Pose{a.x, a.y, a.yaw}, math::Pose{b.x, b.y, b.yaw}));
    const double distance = std::hypot(error.x, error.y),
                 angle = std::abs(math::wrap_angle(error.yaw)) * 180.0 / math::kPi;
    ++pairs;
    farthest = std::max(farthest, distance);
    if (distance > 0.06 || angle > 1.0) continue;
    distances.push_back(distance);
    angles.push_back(angle);
  }
  ASSERT_EQ(pairs, 108U);
  ASSERT_GE(distances.size(), 88U);
  EXPECT_LT(farthest, 0.5) << "some part of the lab does not close";
  const double distance = math::median_of(distances), angle = math::median_of(angles);
  std::printf("%zu matches, %zu odometry, %zu loops; %zu of %zu pairs, median %.1f mm, %.2f degrees\n",
              made.count(EdgeSource::match), made.count(EdgeSource::odometry), made.count(EdgeSource::loop),
              distances.size(), pairs, 1e3 * distance, angle);
  for (const auto& [reason, count] : made.refused) std::printf("refused %zu: %s\n", count, reason.c_str());
  EXPECT_GT(made.count(EdgeSource::loop), 250U);
  // The published figures to the digits they have. With a range noise of 4.5 to 10 mm instead of the estimate
  // 9.9 to 11.3 mm and 0.17 to 0.183 degrees were measured.
  EXPECT_LE(distance, 10.6e-3);
  EXPECT_LT(angle, 0.185);
}

}  // namespace
}  // namespace odomcalib::calib::slam::scan_graph_test
