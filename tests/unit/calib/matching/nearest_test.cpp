#include "calib/matching/nearest.hpp"

#include <gtest/gtest.h>

#include <random>

#include "calib/matching/point_to_point.hpp"

namespace odomcalib::calib::matching::nearest_test {
namespace {

std::vector<Eigen::Vector2d> random_points(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(uniform(engine), uniform(engine));
  return points;
}

TEST(Nearest, S2_02_the_tree_finds_what_comparing_with_every_point_finds) {
  for (const std::size_t count : {1U, 2U, 9U, 700U}) {
    const auto points = random_points(count, 1);
    const NearestTree tree(points);
    for (const Eigen::Vector2d& query : random_points(500, 2)) {
      const Neighbour expected = nearest_of_all(points, query);
      const Neighbour found = tree.nearest(query);
      ASSERT_EQ(found.index, expected.index) << count << " points, query " << query.transpose();
      ASSERT_EQ(found.squared_distance, expected.squared_distance);
    }
  }
}

TEST(Nearest, the_order_of_bearings_finds_what_comparing_with_every_point_finds) {
  for (const std::size_t count : {1U, 2U, 9U, 700U}) {
    const auto points = random_points(count, 1);
    const BearingOrder order(points);
    for (Eigen::Vector2d query : random_points(2000, 2)) {
      if (query.x() > 4.0) query *= 0.01;  // next to the sensor, where every bearing is near
      const Neighbour expected = nearest_of_all(points, query);
      for (const double reach : {0.05, 0.5, 20.0}) {
        const auto found = order.nearest(query, reach);
        ASSERT_EQ(found.has_value(), expected.squared_distance <= reach * reach);
        if (!found) continue;
        ASSERT_EQ(found->index, expected.index) << count << " points, query " << query.transpose();
        ASSERT_EQ(found->squared_distance, expected.squared_distance);
      }
    }
  }
  EXPECT_FALSE(BearingOrder({}).nearest({1.0, 2.0}, 10.0));
}

TEST(PointToPoint, S2_04_recovers_a_known_motion_of_the_same_points) {
  const auto points = random_points(300, 3);
  const math::Pose motion{0.05, -0.03, 0.02};
  std::vector<Eigen::Vector2d> moved;  // the same points as the moved sensor sees them
  for (const Eigen::Vector2d& p : points) {
    const math::Pose seen = between(motion, math::Pose{p.x(), p.y(), 0.0});
    moved.emplace_back(seen.x, seen.y);
  }
  const IcpResult result = match_point_to_point(NearestTree(points), moved, {}, {});
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.motion.x, motion.x, 1e-6);
  EXPECT_NEAR(result.motion.y, motion.y, 1e-6);
  EXPECT_NEAR(result.motion.yaw, motion.yaw, 1e-6);
  EXPECT_LT(result.rms, 1e-6);
}

TEST(PointToPoint, S2_04_failure_is_no_success) {
  const auto points = random_points(300, 4);
  std::vector<Eigen::Vector2d> elsewhere;
  elsewhere.reserve(points.size());
  for (const Eigen::Vector2d& p : points) elsewhere.emplace_back(p.x() + 100.0, p.y());
  EXPECT_FALSE(match_point_to_point(NearestTree(points), elsewhere, {}, {}).converged);
  EXPECT_FALSE(match_point_to_point(NearestTree(points), {}, {}, {}).converged);
  EXPECT_FALSE(match_point_to_point(NearestTree({}), points, {}, {}).converged);
  EXPECT_FALSE(
      match_point_to_point(NearestTree(points), points, {0.05, 0.0, 0.0}, {.max_iterations = 1}).converged);
}

}  // namespace
}  // namespace odomcalib::calib::matching::nearest_test
