#include "tests/sim/world/lidar_head.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim::lidar_head_test {
namespace {

constexpr double kPi = std::numbers::pi;

LidarOptions ideal() {
  LidarOptions options;
  options.range_noise = 0.0;
  options.resolution = 0.0;
  options.grazing_cosine = 0.0;
  options.random_drops = 0.0;
  options.first_turn_starts = 0.0;
  options.turns_per_second = 10.0;
  return options;
}

std::vector<Beam> one_turn(LidarHead& head, const Pose& from, const Pose& to) {
  std::vector<Beam> beams;
  head.advance(0.0, from, 0.1 - 1e-9, to, beams);
  return beams;
}

TEST(Room, casts_the_exact_distance_to_the_walls_of_a_box) {
  const Room room = box_room(5.0, 4.0, 2.0, 1.0);  // x in [-2, 3], y in [-1, 3]
  EXPECT_NEAR(room.cast({0, 0}, 0.0)->range, 3.0, 1e-12);
  EXPECT_NEAR(room.cast({0, 0}, kPi / 2)->range, 3.0, 1e-12);
  EXPECT_NEAR(room.cast({0, 0}, kPi)->range, 2.0, 1e-12);
  EXPECT_NEAR(room.cast({0, 0}, -kPi / 2)->range, 1.0, 1e-12);
  EXPECT_NEAR(room.cast({0, 0}, -kPi / 4)->range, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(room.cast({0, 0}, -kPi / 3)->incidence_cosine, std::sin(kPi / 3), 1e-12);
}

TEST(Room, casts_the_radius_of_a_round_wall_within_the_facets) {
  Room room;
  room.add_pillar({0.0, 0.0}, 4.0, 256);
  for (int i = 0; i < 100; ++i) {
    const double range = room.cast({0, 0}, 0.0628 * i)->range;
    EXPECT_LE(range, 4.0 + 1e-12);
    EXPECT_GE(range, 4.0 * std::cos(kPi / 256) - 1e-12);
  }
}

TEST(Room, nothing_is_hit_outside_and_clearance_is_the_nearest_wall) {
  const Room room = box_room(5.0, 4.0, 2.0, 1.0);
  EXPECT_FALSE(room.cast({10.0, 0.0}, 0.0).has_value());
  EXPECT_NEAR(room.clearance({0.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(room.clearance({4.0, 4.0}), std::sqrt(2.0), 1e-12);
}

TEST(LidarHead, turns_clockwise_and_sees_the_right_wall_after_a_quarter_turn) {
  const Room room = box_room(5.0, 4.0, 2.0, 1.0);
  LidarOptions options = ideal();
  options.beams_per_turn = 360;
  LidarHead head(room, {}, options, 1);
  const auto beams = one_turn(head, {}, {});
  ASSERT_EQ(beams.size(), 360U);
  EXPECT_NEAR(beams[0].range, 3.0, 1e-9);
  EXPECT_NEAR(beams[90].range, 1.0, 1e-9);  // clockwise: right side first
  EXPECT_NEAR(beams[180].range, 2.0, 1e-9);
  EXPECT_NEAR(beams[270].range, 3.0, 1e-9);
  EXPECT_NEAR(beams[90].t, 0.025, 1e-12);
  EXPECT_NEAR(beams[90].clockwise, kPi / 2, 1e-12);
}

TEST(LidarHead, looks_from_its_mount_on_the_base) {
  const Room room = box_room(5.0, 4.0, 2.0, 1.0);
  LidarOptions options = ideal();
  options.beams_per_turn = 360;
  LidarHead head(room, {0.2, 0.3, kPi / 2}, options, 1);
  const auto beams = one_turn(head, {}, {});
  EXPECT_NEAR(beams[0].range, 3.0 - 0.3, 1e-9);
  EXPECT_NEAR(beams[90].range, 3.0 - 0.2, 1e-9);
}

TEST(LidarHead, casts_every_beam_from_the_pose_at_its_own_time) {
  const Room room = box_room(5.0, 4.0, 2.0, 1.0);
  LidarOptions options = ideal();
  options.beams_per_turn = 360;
  LidarHead head(room, {}, options, 1);
  const auto beams = one_turn(head, {}, {0.1 - 1e-9, 0.0, 0.0});  // 1 m/s forward
  EXPECT_NEAR(beams[0].range, 3.0, 1e-9);
  EXPECT_NEAR(beams[180].range, 2.0 + 0.05, 1e-6);
}

TEST(LidarHead, noise_has_the_stated_spread_and_no_bias) {
  const Room room = box_room(6.0, 6.0, 3.0, 3.0);
  LidarOptions options = ideal();
  options.range_noise = 0.008;
  LidarHead head(room, {}, options, 5);
  std::vector<Beam> beams;
  head.advance(0.0, {}, 10.0, {}, beams);
  double sum = 0.0, sum2 = 0.0;
  for (const Beam& beam : beams) {
    const double error = beam.range - room.cast({0, 0}, -beam.clockwise)->range;
    sum += error;
    sum2 += error * error;
  }
  const double n = static_cast<double>(beams.size());
  EXPECT_NEAR(sum / n, 0.0, 5.0 * 0.008 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.008, 0.008 * 5.0 / std::sqrt(2.0 * n));
}

TEST(LidarHead, loses_echoes_at_grazing_incidence_and_out_of_range_only) {
  const Room room = corridor();
  LidarOptions options = ideal();
  options.grazing_cosine = 0.3;
  LidarHead head(room, {}, options, 5);
  std::vector<Beam> beams;
  head.advance(0.0, {}, 20.0, {}, beams);
  std::size_t steep_lost = 0, flat_lost = 0, flat = 0;
  for (const Beam& beam : beams) {
    const auto hit = room.cast({0, 0}, -beam.clockwise);
    if (hit->range > options.range_max) {
      EXPECT_EQ(beam.range, 0.0);
    } else if (hit->incidence_cosine > 0.3) {
      steep_lost += beam.range == 0.0 ? 1 : 0;
    } else {
      ++flat;
      flat_lost += beam.range == 0.0 ? 1 : 0;
    }
  }
  EXPECT_EQ(steep_lost, 0U);
  EXPECT_GT(flat_lost, flat / 4);
  EXPECT_LT(flat_lost, flat);
}

}  // namespace
}  // namespace odomcalib::sim::lidar_head_test
