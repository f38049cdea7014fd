// Which pairs of scans, poses and tuples count as measured motions.
#include "calib/measurement/pair_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/measurement/dataset.hpp"
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

}  // namespace
}  // namespace odomcalib::calib::measurement::pair_builder_test
