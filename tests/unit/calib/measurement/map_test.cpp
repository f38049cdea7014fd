#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/measurement/adjust.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::measurement::map_test {
namespace {

using test_support::kRoom;
using test_support::scan_from;

constexpr double kNoise = 0.01;
const matching::BeamMotion kAtRest = [](double) { return math::Pose{}; };

matching::Walls walls_of(const Scan& scan) {
  return find_walls(matching::make_surface(scan, kAtRest, kNoise), kNoise);
}

/// The room as several scans from known places show it.
WallMap map_of_room() {
  WallMap map;
  unsigned seed = 100;
  for (const math::Pose& pose : {math::Pose{0, 0, 0}, math::Pose{0.5, 1.0, 1.0}, math::Pose{3.0, 2.5, 2.0},
                                 math::Pose{-1.0, -1.0, -2.0}})
    map.insert(walls_of(scan_from(kRoom, pose, kNoise, ++seed)), pose);
  return map;
}

TEST(WallMap, pieces_of_one_wall_become_one) {
  // Six walls, of which two stand out into the room and are seen from both sides; a wall behind them may stay
  // in two.
  EXPECT_LE(map_of_room().walls().size(), 10U);
  EXPECT_GE(map_of_room().walls().size(), 6U);
}

TEST(WallMap, a_beam_strikes_the_nearest_wall_and_no_wall_behind_it) {
  const WallMap map = map_of_room();
  const math::Pose pose{0.0, 0.0, 0.0};
  const auto beams = make_beams(scan_from(kRoom, pose, 0.0, 1), kAtRest);
  const auto strikes = map.strikes(beams, pose);
  EXPECT_GT(strikes.size(), beams.size() / 2);
  for (const Strike& strike : strikes)
    EXPECT_LT(std::abs(map.term(beams[strike.beam], strike.wall, math::Frame(pose), kNoise).residual), 0.05);
}

TEST(WallMap, a_piece_along_a_longer_wall_is_dropped_and_a_ledge_before_it_stays) {
  MapWall wall, piece, ledge;
  wall.centre = {0.0, 2.0};
  wall.normal = piece.normal = ledge.normal = {0.0, -1.0};
  wall.low = -2.0, wall.high = 2.0;
  piece.centre = {1.9, 2.015};
  ledge.centre = {0.0, 1.9};
  piece.low = ledge.low = -0.2, piece.high = ledge.high = 0.2;
  WallMap map;
  map.walls() = {piece, wall, ledge};
  EXPECT_TRUE(map.drop_doubles(0.03));
  ASSERT_EQ(map.walls().size(), 2U);
  EXPECT_EQ(map.walls()[0].centre, wall.centre);
  EXPECT_NEAR(map.walls()[0].high - map.walls()[0].low, 4.1, 1e-9) << "the piece went on beyond the end";
  EXPECT_EQ(map.walls()[1].centre, ledge.centre);
  EXPECT_FALSE(map.drop_doubles(0.03));
}

TEST(WallMap, derivatives_agree_with_central_differences) {
  constexpr double kStep = 1e-6;
  WallMap map = map_of_room();
  const math::Pose pose{0.2, -0.1, 0.3};
  const auto beams = make_beams(scan_from(kRoom, pose, kNoise, 1), kAtRest);
  for (const Strike& strike : map.strikes(beams, pose)) {
    const Beam& beam = beams[strike.beam];
    const RangeTerm term = map.term(beam, strike.wall, math::Frame(pose), kNoise);
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double step) {
        const math::Pose moved{pose.x + (k == 0) * step, pose.y + (k == 1) * step,
                               pose.yaw + (k == 2) * step};
        return map.term(beam, strike.wall, math::Frame(moved), kNoise).residual;
      };
      EXPECT_NEAR((at(kStep) - at(-kStep)) / (2.0 * kStep), term.by_pose(k),
                  1e-4 * (1.0 + std::abs(term.by_pose(k))));
    }
    const MapWall wall = map.walls()[strike.wall];
    const auto with = [&](const Eigen::Vector2d& step) {
      MapWall& moved = map.walls()[strike.wall];
      moved.centre = wall.centre + step(0) * wall.normal;
      moved.normal = Eigen::Rotation2Dd(step(1)) * wall.normal;
      const double residual = map.term(beam, strike.wall, math::Frame(pose), kNoise).residual;
      moved = wall;
      return residual;
    };
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(k);
      EXPECT_NEAR((with(step) - with(-step)) / (2.0 * kStep), term.by_wall(k),
                  1e-4 * (1.0 + std::abs(term.by_wall(k))));
    }
  }
}

/// The room from scans at known places, adjusted, and then 200 scans from other places placed in it.
TEST(PlaceScan, finds_the_place_and_states_its_own_error) {
  WallMap map;
  std::vector<std::vector<Beam>> scans;
  std::vector<Place> places;
  const PlaceOptions options{kNoise, 0.15};
  for (unsigned k = 0; k < 60; ++k) {
    const math::Pose pose{1.5 * std::sin(0.4 * k) - 0.3, 0.9 * std::cos(0.5 * k), 0.3 * k};
    const Scan scan = scan_from(kRoom, pose, kNoise, 1000 + k);
    if (k % 5 == 0) map.insert(walls_of(scan), pose);
    scans.push_back(make_beams(scan, kAtRest));
    places.push_back(place_scan(map, scans.back(), pose, options));
  }
  adjust_map(scans, options, map, places);
  double sum = 0.0;
  constexpr unsigned kScans = 200;
  for (unsigned k = 0; k < kScans; ++k) {
    const math::Pose truth{1.2 * std::sin(0.7 * k) - 0.3, 0.7 * std::cos(0.3 * k), 0.9 * k};
    const auto beams = make_beams(scan_from(kRoom, truth, kNoise, 5000 + k), kAtRest);
    const Place place = place_scan(map, beams, {truth.x + 0.02, truth.y - 0.02, truth.yaw + 0.01}, options);
    ASSERT_TRUE(place.is_usable()) << "scan " << k << ": converged " << place.converged << ", "
                                   << place.inliers << " of " << place.strikes << " beams at " << truth.x
                                   << ", " << truth.y;
    const Eigen::Vector3d error(place.pose.x - truth.x, place.pose.y - truth.y, place.pose.yaw - truth.yaw);
    sum += error.dot(place.information * error) / kScans;
  }
  // Chi-square with three degrees of freedom; the map's frame hangs on the first scan and has that scan's
  // error.
  EXPECT_GT(sum, 2.0);
  EXPECT_LT(sum, 8.0);
}

// Only the readings that noise has shortened come back from a wall just within reach.
TEST(PlaceScan, walls_where_noise_decides_whether_they_are_seen_say_nothing) {
  const WallMap map = map_of_room();
  const math::Pose pose{0.0, 0.0, 0.0};
  const auto beams = make_beams(scan_from(kRoom, pose, kNoise, 1), kAtRest);
  PlaceOptions options{kNoise, 0.15};
  const auto all = fitting_terms(map, beams, pose, options);
  options.range_max = 3.0;
  const auto certain = fitting_terms(map, beams, pose, options);
  const auto near = [](const RangeTerm& term) {
    return term.sighting.range <= matching::far_limit(3.0, kNoise);
  };
  EXPECT_EQ(certain.size(), static_cast<std::size_t>(std::count_if(all.begin(), all.end(), near)));
  EXPECT_TRUE(std::all_of(certain.begin(), certain.end(), near));
  EXPECT_LT(certain.size(), all.size());
}

TEST(PlaceScan, a_scan_of_another_room_finds_no_place) {
  const WallMap map = map_of_room();
  const std::vector<test_support::RoomWall> other = {
      {-1, -1.3, 1.6, -0.9}, {1.6, -0.9, 1.1, 1.8}, {1.1, 1.8, -1, -1.3}};
  const Place place =
      place_scan(map, make_beams(scan_from(other, {}, kNoise, 1), kAtRest), {}, {kNoise, 0.15});
  EXPECT_FALSE(place.is_usable());
}

TEST(PlaceScan, along_a_corridor_the_place_is_not_usable) {
  WallMap map;
  const Scan scan = scan_from(test_support::kCorridor, {}, kNoise, 1);
  map.insert(walls_of(scan), {});
  EXPECT_FALSE(place_scan(map, make_beams(scan, kAtRest), {}, {kNoise, 0.15}).is_usable());
}

}  // namespace
}  // namespace odomcalib::calib::measurement::map_test
