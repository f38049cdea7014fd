// One edge, and the linear system that edges add up to. Test names begin with the requirement they show.
#include <gtest/gtest.h>

#include "calib/slam/descent.hpp"
#include "tests/unit/calib/slam/graph_support.hpp"

namespace odomcalib::calib::slam::graph_factor_test {
namespace {

constexpr unsigned kSeed = 20100301;

class GraphFactor : public ::testing::Test {
 protected:
  math::Pose random_pose() { return {position_(engine_), position_(engine_), angle_(engine_)}; }
  GraphEdge random_edge() {
    const math::Pose z = random_pose();
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([this] { return position_(engine_); });
    const Eigen::Matrix3d I = root * root.transpose();
    return {0, 1, {z.x, z.y, z.yaw}, {I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2)}};
  }
  std::mt19937 engine_{kSeed};
  std::uniform_real_distribution<double> position_{-5.0, 5.0};
  std::uniform_real_distribution<double> angle_{-math::kPi, math::kPi};
};

TEST_F(GraphFactor, S2_25_error_is_the_motion_that_the_measurement_lacks) {
  for (int i = 0; i < 10000; ++i) {
    const math::Pose from = random_pose();
    const math::Pose error{position_(engine_), position_(engine_), angle_(engine_)};
    const GraphEdge edge = random_edge();
    const math::Pose to =
        compose(from, compose(math::Pose{edge.motion[0], edge.motion[1], edge.motion[2]}, error));
    const Eigen::Vector3d e = edge_error(edge, {from, to});
    EXPECT_NEAR(e[0], error.x, 1e-12);
    EXPECT_NEAR(e[1], error.y, 1e-12);
    EXPECT_NEAR(math::wrap_angle(e[2] - error.yaw), 0.0, 1e-12);
    EXPECT_LE(std::abs(e[2]), math::kPi);
  }
}

TEST_F(GraphFactor, S2_27_hand_computed_poses) {
  // At (1, 2) looking along y, the other two metres ahead and one to the left, turned by another quarter.
  const GraphEdge exact{0, 1, {2.0, 1.0, math::kPi / 2.0}, {1, 0, 0, 1, 0, 1}};
  EXPECT_NEAR(edge_error(exact, {{1.0, 2.0, math::kPi / 2.0}, {0.0, 4.0, math::kPi}}).norm(), 0.0, 1e-12);
  // 0.1 m further along the other's x, which points to -x of the map.
  EXPECT_NEAR(edge_error(exact, {{1.0, 2.0, math::kPi / 2.0}, {-0.1, 4.0, math::kPi}})[0], 0.1, 1e-12);
}

TEST_F(GraphFactor, S2_28_error_is_a_turned_difference_of_positions) {
  for (int i = 0; i < 1000; ++i) {
    const Placement at{random_pose(), random_pose()};
    const GraphEdge edge = random_edge();
    const Eigen::Vector2d apart(at[1].x - at[0].x, at[1].y - at[0].y);
    const Eigen::Vector2d seen =
        Eigen::Rotation2Dd(-edge.motion[2]) *
        (Eigen::Rotation2Dd(-at[0].yaw) * apart - Eigen::Vector2d(edge.motion[0], edge.motion[1]));
    EXPECT_LT((edge_error(edge, at).head<2>() - seen).norm(), 1e-12);
  }
}

// With the translation of Z in the derivatives, or without its rotation, this fails.
TEST_F(GraphFactor, S2_14_S2_29_S2_30_S2_31_derivatives_match_central_differences) {
  for (int i = 0; i < 10000; ++i) {
    const Placement at{random_pose(), random_pose()};
    const GraphEdge edge = random_edge();
    const EdgeJacobians J = edge_jacobians(edge, at);
    const Eigen::Matrix3d from = test_support::numeric_jacobian(edge, at, 0);
    const Eigen::Matrix3d to = test_support::numeric_jacobian(edge, at, 1);
    ASSERT_LT((J.from - from).norm(), 1e-6 * from.norm()) << "seed " << kSeed << " edge " << i;
    ASSERT_LT((J.to - to).norm(), 1e-6 * to.norm()) << "seed " << kSeed << " edge " << i;
  }
}

TEST_F(GraphFactor, S2_11_chi2_is_the_sum_over_all_entries) {
  const GraphEdge edge{0, 1, {1, 0, 0}, {2, 0.1, 0.2, 3, 0.3, 4}};
  const Eigen::Vector3d e(0.5, -0.25, 0.125);
  const Placement at{{0, 0, 0}, {1.5, -0.25, 0.125}};
  const double by_hand = 2 * e[0] * e[0] + 3 * e[1] * e[1] + 4 * e[2] * e[2] +
                         2 * (0.1 * e[0] * e[1] + 0.2 * e[0] * e[2] + 0.3 * e[1] * e[2]);
  EXPECT_NEAR(chi2(edge, at), by_hand, 1e-14);
}

TEST_F(GraphFactor, S2_15_sparse_sums_equal_a_dense_reference) {
  auto world = test_support::WorldMaker({.poses = 40, .anisotropic = true, .points = 3}, kSeed).make();
  Placement at = world.truth;
  for (math::Pose& pose : at)
    pose = compose(pose, math::Pose{0.1 * position_(engine_), 0.1 * position_(engine_), 0.1});
  const auto places = elimination_places(at.size(), links_of(world.graph));
  NormalEquations equations(world.graph, places, Freedom::poses);
  EXPECT_NEAR(equations.linearize(at), chi2(world.graph, at), 1e-9 * chi2(world.graph, at));
  ASSERT_FALSE(equations.factorize(0.0));
  const Placement moved = equations.move(at, equations.solve());

  // The dense one over the same unknowns: neither the fixed vertex nor the headings of points.
  const auto dense = test_support::dense_system(world.graph, at, test_support::numeric_jacobian);
  std::vector<Eigen::Index> rows;
  for (std::size_t v = 1; v < at.size(); ++v)
    for (Eigen::Index k = 0; k < (world.graph.vertices[v].kind == VertexKind::pose ? 3 : 2); ++k)
      rows.push_back(static_cast<Eigen::Index>(3 * v) + k);
  ASSERT_EQ(equations.unknowns(), static_cast<Eigen::Index>(rows.size()));
  const Eigen::VectorXd step = dense.hessian(rows, rows).ldlt().solve(dense.b(rows));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto v = static_cast<std::size_t>(rows[r] / 3);
    const auto k = rows[r] % 3;
    const double difference = k == 0   ? moved[v].x - at[v].x
                              : k == 1 ? moved[v].y - at[v].y
                                       : math::wrap_angle(moved[v].yaw - at[v].yaw);
    EXPECT_NEAR(difference, step[static_cast<Eigen::Index>(r)], 1e-6 * (1.0 + step.norm()));
  }
}

TEST_F(GraphFactor, S2_16_one_step_on_a_quadratic_problem_lands_on_the_optimum) {
  auto graph = test_support::graph_of("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 1 2 0 0 3 0 0 1 0 1\n");
  graph.vertices[0].fixed = true;
  NormalEquations equations(graph, elimination_places(2, links_of(graph)), Freedom::poses);
  equations.linearize({{}, {-7.0, 0.0, 0.0}});
  ASSERT_FALSE(equations.factorize(0.0));
  EXPECT_NEAR(equations.move({{}, {-7.0, 0.0, 0.0}}, equations.solve())[1].x, 1.75, 1e-14);
}

TEST_F(GraphFactor, S2_20_the_matrix_of_a_chain_stays_sparse) {
  // 10,000 poses: a dense H would need 7 GB; this one is made and factorised in a few MB.
  PoseGraph graph;
  for (std::size_t i = 0; i < 10000; ++i) {
    graph.vertices.push_back({static_cast<std::int64_t>(i), VertexKind::pose, 0, 0, 0, i == 0});
    if (i > 0) graph.edges.push_back({i - 1, i, {1, 0, 0}, {1, 0, 0, 1, 0, 1}});
  }
  NormalEquations equations(graph, elimination_places(10000, links_of(graph)), Freedom::poses);
  equations.linearize(Placement(10000));
  EXPECT_FALSE(equations.factorize(0.0));
  EXPECT_EQ(equations.unknowns(), 29997);
}

}  // namespace
}  // namespace odomcalib::calib::slam::graph_factor_test
