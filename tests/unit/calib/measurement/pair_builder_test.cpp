// Pairs of scans, poses and tuples that count as measured motions.
#include "calib/measurement/pair_builder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "calib/measurement/dataset.hpp"
#include "calib/measurement/settings.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::measurement::pair_builder_test {
namespace {

constexpr double kScanPeriod = 0.2;  // s
constexpr const char* kTurnedTooFar = "turned by nearly half a turn or more";

/// Stands in a room and turns on the spot, from each scan to the next by one of `turns`, in rad.
Recording turning_recording(const std::vector<double>& turns) {
  constexpr int kTicksPerScan = 20;
  Recording recording;
  recording.name = "turning";
  recording.robot = {0.1, 0.1, 0.4, 1e5, std::array{0.0, 0.0, 0.0}, "", ""};
  double yaw = 0.0;
  const auto tick = [&](double t) {
    const auto counts = std::llround(yaw * 0.4 / 0.1 / (2.0 * math::kPi) * 1e5);
    recording.ticks.push_back({t, -counts, counts, 0});
  };
  for (std::size_t k = 0; k <= turns.size(); ++k) {
    const double t = kScanPeriod * static_cast<double>(k);
    recording.scans.push_back(
        test_support::scan_from(test_support::kRoom, {0.5, 0.3, yaw}, 0.005, 40 + unsigned(k)));
    recording.scans.back().t = t;
    for (int i = 0; i < kTicksPerScan; ++i) {
      tick(t + kScanPeriod * i / kTicksPerScan);
      if (k < turns.size()) yaw += turns[k] / kTicksPerScan;
    }
  }
  return recording;
}

PairSet pairs_of(const Recording& recording) {
  auto opened = open_dataset(ingest::Recordings(std::span(&recording, 1)));
  EXPECT_TRUE(opened.ok()) << opened.error().text();
  if (!opened) return {};
  const Dataset dataset = std::move(opened).value();
  const Eigen::VectorXd parameters = vehicle::to_vector(dataset.nominal);
  return build_pairs(recording, *dataset.models.front(), vehicle::as_span(parameters), {}, {});
}

TEST(PairBuilder, SD_04_a_failed_match_yields_no_pair_and_all_others_have_times_of_their_own) {
  Recording recording = turning_recording(std::vector<double>(8, 0.4));
  ASSERT_EQ(pairs_of(recording).pairs.size(), 8U);
  Scan elsewhere = test_support::scan_from(test_support::kHall, {0.5, 0.3, 1.2}, 0.005, 7);
  elsewhere.t = recording.scans[3].t;
  recording.scans[3] = elsewhere;
  const PairSet set = pairs_of(recording);
  EXPECT_EQ(set.unmatched, 2U) << "to it and from it";
  ASSERT_EQ(set.pairs.size(), 6U);
  for (std::size_t k = 0; k < set.pairs.size(); ++k) {
    const SensorPair& pair = set.pairs[k];
    const double begin = kScanPeriod * static_cast<double>(k < 2 ? k : k + 2);
    EXPECT_NEAR(pair.interval.begin, begin, 1e-9);
    EXPECT_NEAR(pair.interval.end, begin + kScanPeriod, 1e-9);
    EXPECT_NEAR(pair.motion.yaw, 0.4, 0.01);
    EXPECT_EQ(pair.follows_previous, k != 0 && k != 2) << k;
  }
}

TEST(PairBuilder, S3_07_scans_between_which_the_robot_turned_by_nearly_half_a_turn_make_no_pair) {
  for (const double turn : {2.7, 2.9, -2.9, 3.4, 6.0}) {
    const PairSet set = pairs_of(turning_recording({0.4, 0.4, turn, 0.4}));
    const bool is_clear = std::abs(turn) < 2.8;
    EXPECT_EQ(set.rejected.count(kTurnedTooFar), is_clear ? 0U : 1U) << turn;
    ASSERT_EQ(set.pairs.size(), is_clear ? 4U : 3U) << turn;
    EXPECT_EQ(set.pairs.back().follows_previous, is_clear) << turn;
  }
}

TEST(PairBuilder, S3_07_tuples_and_poses_obey_the_same_limit) {
  Recording tuples;
  tuples.name = "tuples";
  for (const double turn : {0.3, 2.9, 0.3, 2.7})
    tuples.increments.push_back({1.0, -turn, turn, {0.0, 0.0, turn}});
  const PairSet set = pairs_of(tuples);
  EXPECT_EQ(set.rejected.at(kTurnedTooFar), 1U);
  ASSERT_EQ(set.pairs.size(), 3U);
  EXPECT_NEAR(set.pairs[1].interval.begin, 2.0, 1e-12) << "the time of what was left out goes by";
  EXPECT_FALSE(set.pairs[1].follows_previous);
  EXPECT_TRUE(set.pairs[2].follows_previous);

  Recording watched = turning_recording({0.6, 0.6, 2.9, 0.6});
  double yaw = 0.0;
  for (std::size_t k = 0; k < watched.scans.size(); ++k) {
    watched.poses.push_back({watched.scans[k].t, 0.0, 0.0, yaw});
    if (k < 4) yaw += k == 2 ? 2.9 : 0.6;
  }
  watched.scans.clear();
  EXPECT_EQ(pairs_of(watched).rejected.count(kTurnedTooFar), 1U);
  EXPECT_EQ(pairs_of(watched).pairs.size(), 3U);
}

/// Drives among `walls` in wide bends, 0.25 m/s, one turn a minute; the lidar sits in the middle of the axle.
/// @param is_held wheels turn, the robot stands
Recording bending_recording(const std::vector<test_support::RoomWall>& walls, bool is_held = false) {
  constexpr double kCounts = 1e5, kRadius = 0.05, kTrack = 0.4, kStep = 0.01, kTurns = 2.0 * math::kPi;
  Recording recording;
  recording.name = "bending";
  recording.robot = {2.0 * kRadius, 2.0 * kRadius, kTrack, kCounts, std::array{0.0, 0.0, 0.0}, "", ""};
  math::Pose pose{-1.0, 0.0, 0.1};
  double left = 0.0, right = 0.0;
  for (int k = 0; k <= 1200; ++k) {
    const double t = kStep * k, way = 0.25 * kStep, turn = 0.15 * std::sin(0.8 * t) * kStep;
    if (k % 20 == 0) {
      recording.scans.push_back(test_support::scan_from(walls, pose, 0.004, 900 + unsigned(k), 360));
      recording.scans.back().range_max = 5.0;
      for (float& range : recording.scans.back().ranges)
        if (range > 5.0F) range = 0.0F;
      recording.scans.back().t = t;
    }
    recording.ticks.push_back(
        {t, std::llround(left / kTurns * kCounts), std::llround(right / kTurns * kCounts), 0});
    left += (way - 0.5 * kTrack * turn) / kRadius;
    right += (way + 0.5 * kTrack * turn) / kRadius;
    if (!is_held) pose = compose(pose, math::exp_se2<double>(way, 0.0, turn));
  }
  return recording;
}

/// Where the robot of that recording is at a time, by its own wheels.
math::Pose by_wheels(const Recording& recording, const SensorPair& pair) {
  auto opened = open_dataset(ingest::Recordings(std::span(&recording, 1)));
  const Eigen::VectorXd nominal = vehicle::to_vector(opened.value().nominal);
  const auto path = opened.value().models.front()->trajectory(vehicle::as_span(nominal), {});
  return between(path.at(pair.interval.begin), path.at(pair.interval.end));
}

const std::vector<test_support::RoomWall> kOneWall = {{-40, 1.0, 40, 1.0}};

TEST(PairBuilder, of_one_wall_pairs_say_what_it_shows_and_leave_its_direction_open) {
  const Recording recording = bending_recording(kOneWall);
  const PairSet set = pairs_of(recording);
  EXPECT_LT(2 * set.readings, set.beams) << "most beams met nothing";
  ASSERT_GE(set.pairs.size(), 10U);
  EXPECT_EQ(set.partial, set.pairs.size());
  EXPECT_EQ(set.stood, 0U) << "a robot that goes along a wall does not stand";
  for (const SensorPair& pair : set.pairs) {
    EXPECT_TRUE(pair.is_partial);
    EXPECT_FALSE(pair.follows_previous);
    const math::Pose truth = by_wheels(recording, pair);
    EXPECT_NEAR(pair.motion.yaw, truth.yaw, 5.0 * std::sqrt(pair.covariance(2, 2)));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(
        Eigen::Matrix2d(pair.covariance.topLeftCorner<2, 2>()));
    EXPECT_LT(std::sqrt(spread.eigenvalues()(0)), 5e-3);
    EXPECT_NEAR(std::sqrt(spread.eigenvalues()(1)), settings::kOpenDirection_m,
                0.1 * settings::kOpenDirection_m);
    const Eigen::Vector2d error(pair.motion.x - truth.x, pair.motion.y - truth.y);
    EXPECT_LT(std::abs(spread.eigenvectors().col(0).dot(error)), 5.0 * std::sqrt(spread.eigenvalues()(0)));
  }
}

TEST(PairBuilder, where_walls_stand_all_round_no_pair_is_partial) {
  const PairSet set = pairs_of(bending_recording(test_support::kRoom));
  EXPECT_EQ(set.partial, 0U);
  EXPECT_EQ(set.stood, 0U);
  EXPECT_EQ(set.unmatched, 0U);
}

TEST(PairBuilder, readings_without_a_surface_make_no_pair_of_either_kind) {
  Recording recording = bending_recording(test_support::kRoom);
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> range(0.3F, 4.9F);
  for (Scan& scan : recording.scans)
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam)
      scan.ranges[beam] = beam % 3 == 0 ? range(engine) : 0.0F;
  EXPECT_EQ(pairs_of(recording).pairs.size(), 0U);
}

TEST(PairBuilder, a_robot_that_stands_before_a_wall_while_its_wheels_turn_makes_no_pair) {
  const std::vector<test_support::RoomWall> ahead = {{1.0, -1.0, 1.0, 1.0}};
  const PairSet set = pairs_of(bending_recording(ahead, true));
  EXPECT_EQ(set.pairs.size(), 0U);
  EXPECT_GE(set.stood, 10U);
  EXPECT_EQ(pairs_of(bending_recording({{4.5, -6.0, 4.5, 6.0}})).stood, 0U);
}

}  // namespace
}  // namespace odomcalib::calib::measurement::pair_builder_test
