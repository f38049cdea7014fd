#include "calib/matching/pose_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/matching/surface.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace odomcalib::calib::matching::pose_search_test {
namespace {

using test_support::kRoom;
using test_support::scan_from;

std::vector<Eigen::Vector2d> points_of(const Scan& scan, std::size_t stride) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < scan.ranges.size(); i += stride)
    if (scan.ranges[i] > 0.0F)
      points.push_back(static_cast<double>(scan.ranges[i]) *
                       Eigen::Vector2d(std::cos(scan.angle(i)), std::sin(scan.angle(i))));
  return points;
}

struct Case {
  LikelihoodField field;
  std::vector<Eigen::Vector2d> points;
  SearchWindow window;
  math::Pose truth;
};

Case random_case(unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const math::Pose a{uniform(engine), uniform(engine), math::kPi * uniform(engine)};
  const math::Pose truth{0.6 * uniform(engine), 0.6 * uniform(engine), 0.6 * uniform(engine)};
  const FieldOptions options{.cell = 0.05 + 0.05 * std::abs(uniform(engine)), .cap = 0.3};
  SearchWindow window{.half_width = 0.8, .half_angle = 0.7, .angle_step = 0.05};
  window.centre = {0.1 * uniform(engine), 0.1 * uniform(engine), 0.1 * uniform(engine)};
  return {LikelihoodField(points_of(scan_from(kRoom, a, 0.02, seed), 2), options),
          points_of(scan_from(kRoom, compose(a, truth), 0.02, seed + 1), 12), window, truth};
}

TEST(PoseSearch, S2_40_branch_and_bound_finds_the_optimum_of_brute_force_with_a_twentieth_of_the_work) {
  std::size_t brute_work = 0;
  std::size_t bound_work = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    Case c = random_case(seed);
    const SearchResult brute = search_brute_force(c.field, c.points, c.window);
    const SearchResult bound = search_branch_and_bound(c.field, c.points, c.window);
    EXPECT_EQ(bound.score, brute.score) << "seed " << seed;
    EXPECT_NEAR(c.field.fit(c.points, bound.pose), bound.score, 0.02) << "seed " << seed;
    brute_work += brute.evaluated;
    bound_work += bound.evaluated;
  }
  EXPECT_GT(brute_work, 20 * bound_work);
}

/// Windows of every size, down to a single pose, some beyond the edge of the map or far outside, lattices
/// from fine to coarse, readings far beyond what the reference saw.
Case odd_case(unsigned seed) {
  Case c = random_case(seed);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  c.points = thinned(c.points, 5 + static_cast<std::size_t>(30.0 * uniform(engine)));
  c.window.half_width = std::max(1.5 * uniform(engine) - 0.2, 0.0);
  c.window.half_angle = std::max(uniform(engine) - 0.1, 0.0);
  c.window.angle_step = std::pow(10.0, -2.0 * uniform(engine));
  if (seed % 10 == 0) c.window.centre.x += 20.0 * (uniform(engine) - 0.5);
  if (seed % 50 == 0) c.window.centre.y = 1e9;
  if (seed % 3 == 0) c.points.emplace_back(40.0 * uniform(engine), 1000.0 * uniform(engine));
  return c;
}

TEST(PoseSearch, S2_40_in_a_thousand_odd_windows_the_optimum_is_that_of_brute_force) {
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    Case c = odd_case(seed);
    const SearchResult brute = search_brute_force(c.field, c.points, c.window);
    const SearchResult bound = search_branch_and_bound(c.field, c.points, c.window);
    ASSERT_EQ(bound.score, brute.score) << "seed " << seed;
  }
}

TEST(PoseSearch, S2_02_the_optimum_is_next_to_the_truth) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Case c = random_case(seed);
    const SearchResult found = search_branch_and_bound(c.field, c.points, c.window);
    const math::Pose error = between(c.truth, found.pose);
    EXPECT_LT(std::hypot(error.x, error.y), 0.15) << "seed " << seed;
    EXPECT_LT(std::abs(math::wrap_angle(error.yaw)), 0.06) << "seed " << seed;
  }
}

TEST(PoseSearch, S2_03_a_hill_climb_never_beats_brute_force_and_never_loses_its_start) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Case c = random_case(seed);
    const SearchResult climb = search_hill_climb(c.field, c.points, c.window.centre, {});
    EXPECT_GE(climb.score, c.field.fit(c.points, c.window.centre)) << "seed " << seed;
    const SearchResult whole = search_brute_force(
        c.field, c.points, {.centre = climb.pose, .half_width = 0.2, .half_angle = 0.1, .angle_step = 0.02});
    EXPECT_GE(whole.score, climb.score - 1e-9) << "the lattice holds the climb's own pose, seed " << seed;
  }
}

TEST(PoseSearch, S2_02_a_hill_climb_reaches_the_summit_from_nearby) {
  const math::Pose a{0.3, 0.2, 0.4};
  const LikelihoodField field(points_of(scan_from(kRoom, a, 0.0, 1), 1), {.cell = 0.02, .cap = 0.5});
  const auto points = points_of(scan_from(kRoom, compose(a, math::Pose{0.1, -0.05, 0.05}), 0.0, 2), 5);
  const SearchResult found = search_hill_climb(field, points, {}, {});
  EXPECT_NEAR(found.pose.x, 0.1, 0.03);
  EXPECT_NEAR(found.pose.y, -0.05, 0.03);
  EXPECT_NEAR(found.pose.yaw, 0.05, 0.01);
}

// LaserSLAM's search window covered -4 to +0.52 m.
TEST(PoseSearch, S2_41_SD_14_the_window_is_symmetric) {
  const Scan scan = scan_from(kRoom, {}, 0.0, 1);
  for (const double sign : {-1.0, 1.0}) {
    LikelihoodField field(points_of(scan, 1), {});
    const auto points = points_of(scan_from(kRoom, {0.9 * sign, 0.9 * sign, 0.0}, 0.0, 1), 5);
    const SearchResult found = search_branch_and_bound(field, points, {});
    EXPECT_NEAR(found.pose.x, 0.9 * sign, 0.11);
    EXPECT_NEAR(found.pose.y, 0.9 * sign, 0.11);
  }
}

// LaserSLAM scored points outside of its map as perfect ones.
TEST(PoseSearch, S2_41_SD_15_leaving_the_map_is_not_rewarded) {
  const auto points = points_of(scan_from(kRoom, {}, 0.0, 1), 1);
  const LikelihoodField field(points, {});
  EXPECT_GT(field.fit(points, {}), 0.99);
  EXPECT_EQ(field.fit(points, {1000.0, 0.0, 0.0}), 0.0);
  EXPECT_EQ(field.fit(points, {-1e12, 1e12, 0.0}), 0.0);
}

TEST(PoseSearch, nothing_to_match_scores_nothing) {
  LikelihoodField field(std::vector<Eigen::Vector2d>{}, {});
  EXPECT_EQ(search_branch_and_bound(field, std::vector<Eigen::Vector2d>{}, {}).score, 0.0);
  EXPECT_EQ(search_brute_force(field, std::vector<Eigen::Vector2d>{{1.0, 1.0}}, {}).score, 0.0);
}

}  // namespace
}  // namespace odomcalib::calib::matching::pose_search_test
