// A recording of wheels and scans becomes a closed graph and a map, every stage of it.
#include "calib/slam/recording_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "calib/math/vector2.hpp"
#include "calib/slam/edge_error.hpp"
#include "calib/slam/optimize.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::slam::recording_map_test {
namespace {

constexpr double kTick = 2e-4, kTrack = 0.4;  // m of travel, m: of the true robot
constexpr double kInterval = 0.05, kSpeed = 0.5, kTurnRate = 0.5;

/// A block with corridors about it, a niche at two of the corners.
const std::vector<test_support::RoomWall> kBlock = {
    {-5, -4, 5, -4},      {5, -4, 5, 4},          {5, 4, -5, 4},    {-5, 4, -5, -4},
    {-3, -2, 3, -2},      {3, -2, 3, 2},          {3, 2, -3, 2},    {-3, 2, -3, -2},
    {-5, -3, -4.6, -3},   {-4.6, -3, -4.6, -2.2}, {4, -4, 4, -3.7}, {4, -3.7, 4.8, -3.7},
    {-1.5, 4, -1.5, 3.7}, {-1.5, 3.7, -0.9, 3.7}};

struct Drive {
  Recording recording;
  std::vector<math::Pose> truth;  ///< of the base at every scan
};

/// Drives at constant wheel speeds; a tick sample each interval, a scan each fifth.
class Driver {
 public:
  Driver() {
    // Nominal values are off by 2 % and 3 %.
    drive_.recording.name = "block";
    drive_.recording.robot.left_wheel_diameter = drive_.recording.robot.right_wheel_diameter = 1.02 * 0.15;
    drive_.recording.robot.track_width = 1.03 * kTrack;
    drive_.recording.robot.ticks_per_rev = math::kPi * 0.15 / kTick;
    drive_.recording.robot.lidar_pose = {0.1, 0.0, 0.0};
    sample();
  }
  void move(double speed, double turn_rate, double duration) {
    for (int i = 0; i < static_cast<int>(std::lround(duration / kInterval)); ++i) {
      const double left = (speed - 0.5 * kTrack * turn_rate) * kInterval,
                   right = (speed + 0.5 * kTrack * turn_rate) * kInterval;
      base_ = compose(base_, wheels::wheel_arc(left, right, kTrack));
      left_ += left;
      right_ += right;
      ++count_;
      sample();
    }
  }
  [[nodiscard]] const Drive& drive() const { return drive_; }

 private:
  void sample() {
    const double t = kInterval * count_;
    drive_.recording.ticks.push_back({t, std::llround(left_ / kTick), std::llround(right_ / kTick), 0});
    if (count_ % 5 != 0) return;
    Scan scan = test_support::scan_from(kBlock, compose(base_, math::Pose{0.1, 0.0, 0.0}), 0.01,
                                        static_cast<unsigned>(count_) + 1);
    scan.t = t;
    drive_.recording.scans.push_back(scan);
    drive_.truth.push_back(base_);
  }

  Drive drive_;
  math::Pose base_{-4.0, -3.0, 0.0};
  double left_ = 0.0, right_ = 0.0;
  int count_ = 0;
};

/// Once and a half round the block.
Drive round_the_block() {
  Driver driver;
  for (const double side : {8.0, 6.0, 8.0, 6.0, 8.0, 6.0}) {
    driver.move(kSpeed, 0.0, side / kSpeed);
    driver.move(0.0, kTurnRate, math::kPi / 2.0 / kTurnRate);
  }
  return driver.drive();
}

/// Error of a keyframe, in the frame of the lidar's first pose.
double error_of(const GraphVertex& vertex, const Drive& drive, std::size_t scan) {
  const math::Pose mount{0.1, 0.0, 0.0};
  const math::Pose truth = between(compose(drive.truth.front(), mount), compose(drive.truth[scan], mount));
  return std::hypot(vertex.x - truth.x, vertex.y - truth.y);
}

double distance_to_walls(const Eigen::Vector2d& p) {
  double nearest = 1e9;
  for (const auto& w : kBlock) {
    const Eigen::Vector2d a(w.x1, w.y1), along = Eigen::Vector2d(w.x2, w.y2) - a;
    const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - a - share * along).norm());
  }
  return nearest;
}

TEST(RecordingMap, S2_01_from_scans_and_ticks_to_a_closed_graph_and_a_map) {
  const Drive drive = round_the_block();
  const auto made = map_recording(drive.recording, {});
  ASSERT_TRUE(made.ok()) << made.error().text();
  const RecordingMap& map = made.value();
  EXPECT_GE(map.made.count(EdgeSource::loop), 1U);
  double by_odometry = 0.0, settled = 0.0;
  for (std::size_t k = 0; k < map.made.scans.size(); ++k) {
    by_odometry = std::max(by_odometry, error_of(map.by_odometry.vertices[k], drive, map.made.scans[k]));
    settled = std::max(settled, error_of(map.made.graph.vertices[k], drive, map.made.scans[k]));
  }
  std::printf("%zu keyframes, %zu loops; farthest from the truth %.3f m by odometry, %.4f m in the graph\n",
              map.made.scans.size(), map.made.count(EdgeSource::loop), by_odometry, settled);
  EXPECT_GT(by_odometry, 0.3);
  EXPECT_LT(settled, 0.01);
  // 42 m of way and six quarter turns, by wheels that claim 2 % too much of one and lack 1 % of the other.
  EXPECT_NEAR(static_cast<double>(map.made.scans.size()), 42.0 * 1.02 / 0.5 + 6.0 * math::kPi / 2.0 / 0.5,
              15.0);
}

TEST(RecordingMap, S2_23_SD_16_each_edge_tells_motion_information_score_and_how_it_came_about) {
  const auto made = map_recording(round_the_block().recording, {});
  ASSERT_TRUE(made.ok()) << made.error().text();
  const ScanGraph& graph = made.value().made;
  ASSERT_EQ(graph.sources.size(), graph.graph.edges.size());
  ASSERT_EQ(graph.overlaps.size(), graph.graph.edges.size());
  for (std::size_t e = 0; e < graph.sources.size(); ++e) {
    const GraphEdge& edge = graph.graph.edges[e];
    EXPECT_EQ(graph.sources[e] == EdgeSource::loop, edge.to != edge.from + 1) << "edge " << e;
    EXPECT_EQ(graph.overlaps[e] > 0.2, graph.sources[e] != EdgeSource::odometry) << "edge " << e;
    EXPECT_LE(graph.overlaps[e], 1.5) << "edge " << e;
    EXPECT_TRUE(information_of(edge).llt().info() == Eigen::Success) << "edge " << e;
  }
}

TEST(RecordingMap, S2_40_the_occupied_cells_are_the_walls) {
  const Drive drive = round_the_block();
  const auto made = map_recording(drive.recording, {});
  ASSERT_TRUE(made.ok()) << made.error().text();
  const math::Frame first(compose(drive.truth.front(), math::Pose{0.1, 0.0, 0.0}));
  std::size_t far = 0;
  for (const Eigen::Vector2d& centre : made.value().occupied)
    if (distance_to_walls(first.transform(centre)) > 1.5 * made.value().cell) ++far;
  EXPECT_GT(made.value().occupied.size(), 500U);  // 60 m of walls in cells of 5 cm, most of them seen
  EXPECT_LT(far, made.value().occupied.size() / 50);
  const auto& last = made.value().last_scan;
  EXPECT_GT(last.size(), 100U);
  for (const Eigen::Vector2d& seen : last) EXPECT_LT(distance_to_walls(first.transform(seen)), 0.1);
}

TEST(RecordingMap, S2_05_the_graph_that_is_written_is_settled) {
  const auto made = map_recording(round_the_block().recording, {});
  ASSERT_TRUE(made.ok()) << made.error().text();
  auto again = read_pose_graph_text(to_g2o(made.value().made.graph), "again");
  ASSERT_TRUE(again.ok()) << again.error().text();
  const double before = graph_chi2(again.value());
  const GraphSummary summary = optimize_graph(again.value());
  ASSERT_TRUE(summary.is_usable()) << summary.reason;
  EXPECT_NEAR(summary.chi2_after, before, 1e-6 * before);
}

TEST(RecordingMap, what_is_missing_is_named) {
  Drive drive = round_the_block();
  Recording no_ticks = drive.recording, no_scans = drive.recording, no_units = drive.recording,
            no_motion = drive.recording;
  no_ticks.ticks.clear();
  no_scans.scans.clear();
  no_units.robot.track_width = 0.0;
  no_motion.ticks.resize(2);
  EXPECT_EQ(map_recording(no_ticks, {}).error().what, "no tick samples");
  EXPECT_EQ(map_recording(no_scans, {}).error().what, "no scans");
  EXPECT_EQ(map_recording(no_units, {}).error().code, ErrorCode::missing_units);
  EXPECT_EQ(map_recording(no_motion, {}).error().what, "fewer than two keyframes");
}

}  // namespace
}  // namespace odomcalib::calib::slam::recording_map_test
