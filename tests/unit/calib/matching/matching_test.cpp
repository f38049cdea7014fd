#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "calib/match.hpp"
#include "calib/matching/both_ways.hpp"
#include "calib/matching/point_to_line.hpp"
#include "calib/matching/walls.hpp"
#include "calib/math/se2.hpp"
#include "tests/unit/calib/match_error.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::matching::matching_test {
namespace {

using test_support::kCorridor;
using test_support::kHall;
using test_support::kRoom;
using test_support::ray_distance;
using test_support::RoomWall;
using test_support::scan_from;

TEST(Matching, S2_04_recovers_a_known_motion_from_noise_free_scans) {
  const math::Pose a{0.2, -0.1, 0.1};
  const math::Pose b = compose(a, math::Pose{0.08, 0.03, 0.15});
  const ScanMatch match = match_scans(scan_from(kRoom, a, 0.0, 1), scan_from(kRoom, b, 0.0, 2), {0, 0, 0});
  ASSERT_TRUE(match.ok()) << match.status;
  EXPECT_NEAR(match.pose[0], 0.08, 1e-6);
  EXPECT_NEAR(match.pose[1], 0.03, 1e-6);
  EXPECT_NEAR(match.pose[2], 0.15, 1e-6);
}

TEST(Matching, S2_02_brute_force_needs_no_guess_and_a_climb_needs_one_nearby) {
  const math::Pose a{0.2, -0.1, 0.1};
  const Scan reference = scan_from(kRoom, a, 0.005, 1);
  for (const math::Pose& motion : {math::Pose{0.1, -0.05, 0.05}, math::Pose{0.7, -0.5, 0.6}}) {
    const Scan scan = scan_from(kRoom, compose(a, motion), 0.005, 2);
    const ScanMatch brute = search_scans(reference, scan, {0, 0, 0}, Matcher::brute);
    ASSERT_TRUE(brute.ok()) << brute.status;
    EXPECT_NEAR(brute.pose[0], motion.x, 0.11);
    EXPECT_NEAR(brute.pose[1], motion.y, 0.11);
    EXPECT_NEAR(brute.pose[2], motion.yaw, 0.03);
    const ScanMatch fast =
        search_scans(reference, scan, {motion.x + 0.05, motion.y - 0.05, motion.yaw}, Matcher::fast);
    ASSERT_TRUE(fast.ok()) << fast.status;
    EXPECT_NEAR(fast.pose[0], motion.x, 0.08);
    EXPECT_NEAR(fast.pose[1], motion.y, 0.08);
    EXPECT_NEAR(fast.pose[2], motion.yaw, 0.03);
  }
  Scan empty = reference;
  empty.ranges.assign(empty.ranges.size(), 0.0F);
  EXPECT_EQ(search_scans(reference, empty, {0, 0, 0}, Matcher::brute).status, "too_few_points");
}

double normalised_error_squared(const ScanMatch& match, const math::Pose& motion) {
  return test_support::normalised_squared(match,
                                          test_support::error_of(match, {motion.x, motion.y, motion.yaw}));
}

TEST(Matching, S2_40_errors_agree_with_the_reported_covariance) {
  constexpr unsigned kRuns = 300;
  double squared = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const math::Pose motion{0.1, 0.02, -0.2};
    const math::Pose a{0.1 * (run % 5), 0.05 * (run % 7), 0.3 * run};
    const ScanMatch match =
        match_scans(scan_from(kRoom, a, 0.008, 2 * run),
                    scan_from(kRoom, compose(a, motion), 0.008, 2 * run + 1), {0, 0, 0}, 0.008);
    ASSERT_TRUE(match.ok()) << match.status << " run " << run;
    squared += normalised_error_squared(match, motion);
  }
  std::printf("%u matches: e' C^-1 e is %.3f times its expectation\n", kRuns, squared / (3.0 * kRuns));
  EXPECT_NEAR(squared / (3.0 * kRuns), 1.0, 0.2);
}

// Two degrees are 20 cm at 6 m: the lines through neighbouring ends have to reach farther than in dense
// scans.
TEST(Matching, few_beams_in_a_wide_hall_match_as_they_say) {
  constexpr unsigned kRuns = 200;
  constexpr int kBeams = 180;
  const math::Pose motion{0.15, 0.02, -0.1};
  double squared = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const math::Pose a{0.1 * (run % 5), 0.05 * (run % 7), 0.3 * run};
    const ScanMatch match = match_scans(scan_from(kHall, a, 0.008, 2 * run, kBeams),
                                        scan_from(kHall, compose(a, motion), 0.008, 2 * run + 1, kBeams),
                                        {0.12, 0.0, -0.08}, 0.008);
    ASSERT_TRUE(match.ok()) << match.status << " run " << run;
    squared += normalised_error_squared(match, motion);
  }
  std::printf("%u matches: e' C^-1 e is %.3f times its expectation\n", kRuns, squared / (3.0 * kRuns));
  EXPECT_NEAR(squared / (3.0 * kRuns), 1.0, 0.25);
}

TEST(Matching, the_result_does_not_depend_on_the_guess) {
  const math::Pose motion{0.1, 0.02, -0.2};
  const Scan a = scan_from(kRoom, {}, 0.008, 1);
  const Scan b = scan_from(kRoom, motion, 0.008, 2);
  const ScanMatch left = match_scans(a, b, {0.12, 0.04, -0.18}, 0.008);
  const ScanMatch right = match_scans(a, b, {0.08, 0.0, -0.22}, 0.008);
  ASSERT_TRUE(left.ok() && right.ok());
  EXPECT_LT(std::abs(left.pose[0] - right.pose[0]), 0.02 * 0.04);
  EXPECT_LT(std::abs(left.pose[2] - right.pose[2]), 0.02 * 0.04);
}

/// Half an ellipse of 60 walls ahead of the origin, nothing behind.
std::vector<RoomWall> apse(double deep, double wide) {
  constexpr int kWalls = 60;
  const auto at = [&](int k) {
    const double angle = math::kPi * (static_cast<double>(k) / kWalls - 0.5);
    return std::pair(deep * std::cos(angle), wide * std::sin(angle));
  };
  std::vector<RoomWall> walls;
  walls.reserve(kWalls);
  for (int k = 0; k < kWalls; ++k)
    walls.push_back({at(k).first, at(k).second, at(k + 1).first, at(k + 1).second});
  return walls;
}

// Lines fitted to a bent wall lie on its inner side and readings do not: a lidar that sees nothing but that
// wall ahead seems to have gone backwards, standing or moving.
TEST(Matching, both_ways_a_bent_wall_ahead_moves_nobody) {
  constexpr double kNoise = 0.01;
  constexpr unsigned kRuns = 300;
  const BeamMotion at_rest = [](double) { return math::Pose{}; };
  MatchOptions options;
  options.range_noise = kNoise;
  const auto seen = [&](unsigned seed) {
    return MatchReference(make_surface(scan_from(apse(3.0, 2.0), {}, kNoise, seed), at_rest, kNoise), kNoise);
  };
  double one_way = 0.0, both_ways = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const MatchReference first = seen(2 * run), second = seen(2 * run + 1);
    one_way += match_point_to_line(first, second.surface(), {}, options).motion.x / kRuns;
    both_ways += match_both_ways(first, second, {}, options).motion.x / kRuns;
  }
  std::printf("%u matches: %.3f mm one way, %.3f mm both ways\n", kRuns, 1e3 * one_way, 1e3 * both_ways);
  EXPECT_LT(one_way, -2e-4);
  EXPECT_NEAR(both_ways, 0.0, 2e-4);
}

// Only the readings that noise has shortened come back from a wall at the end of the reach: it seems to come
// nearer more slowly than the robot goes.
TEST(Matching, a_wall_at_the_end_of_the_reach_holds_nobody_back) {
  constexpr double kNoise = 0.03, kReach = 5.0;
  constexpr unsigned kRuns = 400;
  const BeamMotion at_rest = [](double) { return math::Pose{}; };
  const math::Pose motion{0.15, 0.0, 0.0};
  const auto seen = [&](const math::Pose& from, unsigned seed, double reach) {
    Scan scan = scan_from(test_support::kHall, from, kNoise, seed);
    for (float& range : scan.ranges)
      if (static_cast<double>(range) > kReach) range = 0.0F;
    scan.range_max = reach;
    return MatchReference(make_surface(scan, at_rest, kNoise), kNoise);
  };
  const auto mean_error = [&](double reach) {
    double sum = 0.0;
    for (unsigned run = 0; run < kRuns; ++run) {
      const math::Pose from{-0.2 + 1e-3 * run, 0.0, 0.0};
      const MatchReference first = seen(from, 2 * run, reach);
      const MatchReference second = seen(compose(from, motion), 2 * run + 1, reach);
      sum += match_both_ways(first, second, motion, {.range_noise = kNoise}).motion.x - motion.x;
    }
    return sum / kRuns;
  };
  const double known = mean_error(kReach), unknown = mean_error(0.0);
  std::printf("%u matches: %.2f mm off where the reach is known, %.2f mm where it is not\n", kRuns,
              1e3 * known, 1e3 * unknown);
  EXPECT_NEAR(known, 0.0, 8e-4);
  EXPECT_LT(unknown, -1.5e-3);
}

TEST(Matching, both_ways_is_the_inverse_of_the_other_way_round) {
  constexpr double kNoise = 0.008;
  const BeamMotion at_rest = [](double) { return math::Pose{}; };
  const math::Pose motion{0.2, -0.05, 0.3};
  MatchOptions options;
  options.range_noise = kNoise;
  for (const double known : {0.0, 400.0}) {
    options.guess_information = Eigen::Vector3d(known, known, known).asDiagonal();
    const MatchReference first(make_surface(scan_from(kRoom, {}, kNoise, 1), at_rest, kNoise), kNoise);
    const MatchReference second(make_surface(scan_from(kRoom, motion, kNoise, 2), at_rest, kNoise), kNoise);
    const MatchResult there = match_both_ways(first, second, motion, options);
    const MatchResult back = match_both_ways(second, first, inverse(motion), options);
    ASSERT_TRUE(there.is_usable() && back.is_usable());
    const math::Pose apart = compose(there.motion, back.motion);
    EXPECT_NEAR(apart.x, 0.0, 3e-4) << known;
    EXPECT_NEAR(apart.y, 0.0, 3e-4) << known;
    EXPECT_NEAR(apart.yaw, 0.0, 1e-4) << known;
  }
}

TEST(Matching, S1_14_a_corridor_yields_no_pose_along_it) {
  for (const double noise : {0.0, 0.005, 0.02}) {
    const math::Pose motion{0.1, 0.0, 0.3};
    const math::Pose turned{0.0, 0.0, 0.7};  // the corridor runs 0.7 rad to the right of the sensor
    const ScanMatch match = match_scans(scan_from(kCorridor, turned, noise, 1),
                                        scan_from(kCorridor, compose(turned, motion), noise, 2), {0, 0, 0});
    EXPECT_EQ(match.status, "degenerate") << noise;
    EXPECT_NEAR(std::abs(match.weak_direction[0]), std::cos(0.7), 0.05) << noise;
    EXPECT_LT(match.weak_direction[0] * match.weak_direction[1], 0.0) << noise;
  }
}

TEST(Matching, along_a_corridor_a_known_guess_holds_the_scan_and_across_it_counts_nothing) {
  constexpr double kNoise = 0.01;
  const BeamMotion at_rest = [](double) { return math::Pose{}; };
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const math::Pose motion{0.3, 0.1, 0.05}, guess{0.35, 0.08, 0.03};
    MatchOptions options;
    options.range_noise = kNoise;
    options.guess_information = Eigen::Vector3d(400.0, 400.0, 400.0).asDiagonal();  // 5 cm, 3 degrees
    const MatchReference reference(make_surface(scan_from(kCorridor, {}, kNoise, seed), at_rest, kNoise),
                                   kNoise);
    const MatchResult match = match_point_to_line(
        reference, make_surface(scan_from(kCorridor, motion, kNoise, seed + 100), at_rest, kNoise), guess,
        options);
    EXPECT_EQ(match.status, MatchStatus::degenerate)
        << "what the guess knows is no merit of the scans, seed " << seed;
    EXPECT_NEAR(match.motion.x, guess.x, 0.02) << "seed " << seed;
    EXPECT_NEAR(match.motion.y, motion.y, 0.01) << "seed " << seed;
    EXPECT_NEAR(match.motion.yaw, motion.yaw, 0.005) << "seed " << seed;
  }
}

TEST(Matching, a_corridor_with_a_door_frame_is_not_refused) {
  std::vector<RoomWall> walls = kCorridor;
  for (const double x : {-2.0, 1.5, 3.0}) {
    walls.push_back({x, -1.0, x, -0.6});
    walls.push_back({x, 1.0, x, 0.6});
  }
  const ScanMatch match =
      match_scans(scan_from(walls, {}, 0.005, 1), scan_from(walls, {0.1, 0.0, 0.02}, 0.005, 2), {0, 0, 0});
  ASSERT_TRUE(match.ok()) << match.status;
  EXPECT_NEAR(match.pose[0], 0.1, 0.01);
}

TEST(Matching, scans_of_different_rooms_are_refused) {
  const std::vector<RoomWall> other = {
      {-0.5, -5, 0.9, -5}, {0.9, -5, 0.9, 7}, {0.9, 7, -0.5, 7}, {-0.5, 7, -0.5, -5}};
  const ScanMatch match =
      match_scans(scan_from(kRoom, {}, 0.005, 1), scan_from(other, {}, 0.005, 2), {0, 0, 0});
  EXPECT_FALSE(match.ok());
}

// Points that a moved scan sees beyond the ends of what the reference saw used to be pulled back there.
TEST(Matching, missing_beams_do_not_pull_the_motion_towards_zero) {
  constexpr unsigned kRuns = 150;
  constexpr double kStep = 0.15;
  double sum = 0.0;
  double squares = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const math::Pose a{0.1 * (run % 5), 0.05 * (run % 7), 0.3 * run};
    Scan scans[] = {scan_from(kRoom, a, 0.015, 2 * run),
                    scan_from(kRoom, compose(a, math::Pose{kStep, 0.0, 0.0}), 0.015, 2 * run + 1)};
    for (Scan& scan : scans) {
      scan.range_max = 3.2;
      for (float& range : scan.ranges)
        if (range > 3.2F) range = 0.0F;
    }
    const ScanMatch match = match_scans(scans[0], scans[1], {kStep, 0, 0});
    if (!match.ok()) continue;
    const double weight = 1.0 / match.covariance[0][0];
    sum += weight * (match.pose[0] - kStep);
    squares += weight;
  }
  const double bias = sum / squares;
  EXPECT_LT(std::abs(bias), 3.5 / std::sqrt(squares)) << "relative " << bias / kStep;
}

TEST(Matching, an_empty_scan_or_a_single_point_is_refused) {
  Scan empty = scan_from(kRoom, {}, 0.005, 1);
  std::fill(empty.ranges.begin(), empty.ranges.end(), 0.0F);
  EXPECT_EQ(match_scans(empty, scan_from(kRoom, {}, 0.005, 2), {0, 0, 0}).status, "too_few_points");
  empty.ranges[100] = 1.0F;
  EXPECT_EQ(match_scans(scan_from(kRoom, {}, 0.005, 2), empty, {0, 0, 0}).status, "too_few_points");
}

/// Beams a third of a degree apart on a wall 3 m away that bulges by `sagitta` over 2 m.
Surface bulging_wall(double sagitta, double noise, unsigned seed) {
  constexpr double kDistance = 3.0, kHalf = 1.0;  // m
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0.0, noise);
  Surface surface;
  for (double angle = -std::atan(kHalf / kDistance); angle < std::atan(kHalf / kDistance); angle += 6e-3) {
    const double along = kDistance * std::tan(angle);
    const double away = kDistance + sagitta * (1.0 - along * along / (kHalf * kHalf));
    SurfacePoint point{};
    point.beam = {std::cos(angle), std::sin(angle)};
    point.anchor = point.normal = Eigen::Vector2d::Zero();
    point.range = away / std::cos(angle) + error(random);
    point.position = point.range * point.beam;
    surface.points.push_back(point);
  }
  return surface;
}

TEST(Walls, that_are_slightly_bent_are_no_straight_ones) {
  constexpr double kNoise = 0.015;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_EQ(find_walls(bulging_wall(0.0, kNoise, seed), kNoise).walls.size(), 1U) << "seed " << seed;
    EXPECT_GT(find_walls(bulging_wall(0.03, kNoise, seed), kNoise).walls.size(), 1U) << "seed " << seed;
  }
}

TEST(Surface, deskewing_straightens_a_sweep_taken_while_turning) {
  // The head turns counter-clockwise in 0.1 s while the robot turns at 1 rad/s.
  Scan skewed = scan_from(kRoom, {}, 0.0, 1);
  skewed.time_increment = 0.1 / 720.0;
  for (int i = 0; i < 720; ++i) {
    const double yaw = (*skewed.time_increment * i - 0.05) * 1.0;
    skewed.ranges[static_cast<std::size_t>(i)] = static_cast<float>(
        ray_distance(kRoom, 0.0, 0.0, yaw + skewed.angle_min + skewed.angle_increment * i));
  }
  const double middle = reference_time(skewed);
  const Surface straight = make_surface(
      skewed,
      [&](double s) {
        return math::Pose{0.0, 0.0, s - middle};
      },
      0.005);
  const Surface bent = make_surface(
      skewed, [](double) { return math::Pose{}; }, 0.005);
  const auto worst_wall_error = [](const Surface& surface) {
    double worst = 0.0;
    for (const SurfacePoint& p : surface.points)
      if (p.position.y() < -1.5 && std::abs(p.position.x() - 0.5) < 3.0)
        worst = std::max(worst, std::abs(p.position.y() + 2.0));
    return worst;
  };
  EXPECT_LT(worst_wall_error(straight), 2e-3);
  EXPECT_GT(worst_wall_error(bent), 0.05);
}

TEST(Surface, listed_angles_may_wrap_anywhere) {
  Scan listed = scan_from(kRoom, {}, 0.005, 1);
  for (int i = 0; i < 720; ++i)
    listed.angles.push_back(static_cast<float>(math::wrap_angle(1.0 + listed.angle_increment * i)));
  for (int i = 0; i < 720; ++i)
    listed.ranges[static_cast<std::size_t>(i)] = static_cast<float>(
        ray_distance(kRoom, 0, 0, static_cast<double>(listed.angles[static_cast<std::size_t>(i)])));
  const Surface surface = make_surface(
      listed, [](double) { return math::Pose{}; }, 0.005);
  const auto lines = std::count_if(surface.points.begin(), surface.points.end(),
                                   [](const SurfacePoint& p) { return p.has_line; });
  EXPECT_GT(lines, 650);
}

TEST(Surface, estimates_the_range_noise) {
  for (const double noise : {0.004, 0.01, 0.03}) {
    std::vector<Scan> scans;
    for (unsigned i = 0; i < 10; ++i) scans.push_back(scan_from(kRoom, {0.1 * i, 0.0, 0.2 * i}, noise, i));
    EXPECT_NEAR(estimate_range_noise(scans) / noise, 1.0, 0.1) << noise;
  }
}

// One reading in two degrees, a twentieth of them missing, a display in centimetres: no run of neighbours is
// long.
TEST(Surface, estimates_the_range_noise_of_few_beams) {
  for (const double noise : {0.006, 0.014, 0.028}) {
    std::vector<Scan> scans;
    for (unsigned i = 0; i < 60; ++i) {
      const Scan fine = scan_from(kRoom, {0.02 * i, 0.0, 0.2 * i}, noise, i);
      const std::size_t every = fine.ranges.size() / 180;
      Scan scan = fine;
      scan.ranges.clear();
      scan.angle_increment = fine.angle_increment * static_cast<double>(every);
      for (std::size_t k = 0; k < fine.ranges.size(); k += every) {
        const float rounded = std::round(fine.ranges[k] * 100.0F) / 100.0F;
        scan.ranges.push_back((k / every + i) % 20 == 0 ? 0.0F : rounded);
      }
      scans.push_back(scan);
    }
    EXPECT_NEAR(estimate_range_noise(scans) / std::hypot(noise, 0.01 / std::sqrt(12.0)), 1.0, 0.2) << noise;
  }
}

}  // namespace
}  // namespace odomcalib::calib::matching::matching_test
