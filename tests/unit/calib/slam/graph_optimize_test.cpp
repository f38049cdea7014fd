// Whole graphs: known answers, gauges, refusals, statistics. Test names begin with the requirement they show.
#include "calib/slam/optimize.hpp"

#include <gtest/gtest.h>

#include "calib/slam/connectivity.hpp"
#include "tests/unit/calib/slam/graph_support.hpp"

namespace odomcalib::calib::slam::graph_optimize_test {
namespace {

using test_support::graph_of;

/// A step along x in an otherwise rigid plane.
std::string along_x(int from, int to, double metres, double weight = 1.0) {
  return "EDGE_SE2 " + std::to_string(from) + " " + std::to_string(to) + " " + std::to_string(metres) +
         " 0 0 " + std::to_string(weight) + " 0 0 1 0 1\n";
}

std::string seen_ahead(int pose, int point, double metres, double weight = 1.0) {
  return "EDGE_SE2_XY " + std::to_string(pose) + " " + std::to_string(point) + " " + std::to_string(metres) +
         " 0 " + std::to_string(weight) + " 0 1\n";
}

PoseGraph solved(const std::string& text, const GraphOptions& options = {.tolerance = 1e-14}) {
  PoseGraph graph = graph_of(text);
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph, options);
  EXPECT_EQ(summary.state, GraphState::converged) << summary.reason;
  return graph;
}

PoseGraph placed(PoseGraph graph, const Placement& at) {
  for (std::size_t v = 0; v < at.size(); ++v) {
    graph.vertices[v].x = at[v].x;
    graph.vertices[v].y = at[v].y;
    graph.vertices[v].yaw = at[v].yaw;
  }
  return graph;
}

double largest_difference(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0.0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    largest = std::max({largest, std::abs(a.vertices[v].x - b.vertices[v].x),
                        std::abs(a.vertices[v].y - b.vertices[v].y),
                        std::abs(math::wrap_angle(a.vertices[v].yaw - b.vertices[v].yaw))});
  return largest;
}

TEST(GraphOptimize, S2_06_one_metre_on_eight_tenths_back_and_at_the_start_again) {
  PoseGraph graph = graph_of(along_x(0, 1, 1.0) + along_x(1, 2, -0.8) + along_x(2, 0, 0.0));
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph);
  EXPECT_NEAR(graph.vertices[0].x, 0.0, 1e-12);
  EXPECT_NEAR(graph.vertices[1].x, 14.0 / 15.0, 1e-12);
  EXPECT_NEAR(graph.vertices[2].x, 1.0 / 15.0, 1e-12);
  EXPECT_NEAR(summary.chi2_after, 0.04 / 3.0, 1e-12);
}

TEST(GraphOptimize, two_numbers_of_one_place_close_the_loop) {
  auto graph = graph_of(
      "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 2 0 0\nVERTEX2 3 2.5 0.4 0.1\n"
      "EDGE2 0 1 1 0 0 500 0 500 5000 0 0\nEDGE2 1 2 1 0 0 500 0 500 5000 0 0\n"
      "EDGE2 0 3 2.2 0 0 500 0 500 5000 0 0\nEQUIV 2 3\n");
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph);
  EXPECT_NEAR(graph.vertices[2].x, 2.0 + 0.4 / 3.0, 1e-9);
  EXPECT_NEAR(summary.chi2_after, 3.0 * 500.0 * std::pow(0.2 / 3.0, 2), 1e-9);
  // Both numbers stand at that place in what is written.
  const std::string text = to_g2o(graph);
  EXPECT_NE(text.find("VERTEX_SE2 2 2.13333333"), std::string::npos) << text;
  EXPECT_NE(text.find("VERTEX_SE2 3 2.13333333"), std::string::npos) << text;
}

TEST(GraphOptimize, S2_07_without_the_loop_the_odometry_stays) {
  const auto graph = solved(along_x(0, 1, 1.0) + along_x(1, 2, -0.8));
  EXPECT_NEAR(graph.vertices[1].x, 1.0, 1e-12);
  EXPECT_NEAR(graph.vertices[2].x, 0.2, 1e-12);
}

TEST(GraphOptimize, S2_08_a_landmark_seen_twice) {
  const auto graph = solved(along_x(0, 1, 1.0) + seen_ahead(0, 9, 2.0) + seen_ahead(1, 9, 0.8));
  EXPECT_NEAR(graph.vertices[1].x, 16.0 / 15.0, 1e-12);
  EXPECT_NEAR(graph.vertices[2].x, 29.0 / 15.0, 1e-12);
}

TEST(GraphOptimize, S2_09_encoder_edges_that_weigh_ten) {
  const auto graph = solved(along_x(0, 1, 1.0, 10.0) + seen_ahead(0, 9, 2.0) + seen_ahead(1, 9, 0.8));
  EXPECT_NEAR(graph.vertices[1].x, 21.2 / 21.0, 1e-12);
  EXPECT_NEAR(graph.vertices[2].x, 40.0 / 21.0, 1e-12);
}

TEST(GraphOptimize, S2_10_exact_measurements_give_back_the_truth) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto world = test_support::WorldMaker({.anisotropic = true, .points = 10, .noise = 0.0}, seed).make();
    world.graph.has_positions = false;
    const auto summary = optimize_graph(world.graph, {.tolerance = 1e-14});
    ASSERT_EQ(summary.state, GraphState::converged) << summary.reason;
    EXPECT_LT(largest_difference(world.graph, placed(world.graph, world.truth)), 1e-9) << "seed " << seed;
  }
}

TEST(GraphOptimize, S2_13_chi2_is_what_its_degrees_of_freedom_say) {
  constexpr unsigned kRuns = 200;
  double chi2_sum = 0.0;
  double freedom_sum = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    auto world = test_support::WorldMaker({.poses = 60, .heading_sigma = 0.002}, seed).make();
    const auto summary = optimize_graph(world.graph);
    ASSERT_TRUE(summary.is_usable()) << "seed " << seed;
    chi2_sum += summary.chi2_after;
    freedom_sum += static_cast<double>(summary.measured - summary.unknowns);
  }
  EXPECT_GT(freedom_sum, 1000.0);
  EXPECT_NEAR(chi2_sum, freedom_sum, 3.0 * std::sqrt(2.0 * freedom_sum));
}

TEST(GraphOptimize, S2_17_levenberg_marquardt_never_climbs_and_all_methods_agree) {
  const auto world = test_support::WorldMaker({.heading_sigma = 0.03}, 17).make();
  std::vector<double> ends;
  for (const auto method :
       {GraphMethod::automatic, GraphMethod::gauss_newton, GraphMethod::levenberg_marquardt}) {
    PoseGraph graph = world.graph;
    const auto summary = optimize_graph(graph, {.start = GraphStart::tree, .method = method});
    EXPECT_EQ(summary.state, GraphState::converged) << summary.reason;
    double chi2 = summary.chi2_start;
    for (const auto& iteration : summary.iterations) {
      if (!iteration.accepted) continue;
      if (method == GraphMethod::levenberg_marquardt) {
        EXPECT_LE(iteration.chi2, chi2);
        EXPECT_GT(iteration.lambda, 0.0);
      }
      chi2 = iteration.chi2;
    }
    ends.push_back(summary.chi2_after);
  }
  EXPECT_NEAR(ends[1], ends[0], 1e-8 * ends[0]);
  EXPECT_NEAR(ends[2], ends[0], 1e-8 * ends[0]);
}

/// A ring whose start has a whole turn too much in it: every edge is a little off, none looks wrong.
PoseGraph ring_with_a_turn_too_much() {
  constexpr int kPoses = 60;
  std::string edges;
  std::string vertices;
  for (int i = 0; i < kPoses; ++i) {
    const std::string next = std::to_string((i + 1) % kPoses);
    edges += "EDGE_SE2 " + std::to_string(i) + " " + next + " 1 0 " +
             std::to_string(2.0 * math::kPi / kPoses) + " 100 0 0 100 0 400\n";
    const double turned = 4.0 * math::kPi * i / kPoses;
    vertices += "VERTEX_SE2 " + std::to_string(i) + " " + std::to_string(4.8 * std::sin(turned)) + " " +
                std::to_string(4.8 * (1.0 - std::cos(turned))) + " " +
                std::to_string(math::wrap_angle(turned)) + "\n";
  }
  return graph_of(vertices + edges);
}

TEST(GraphOptimize, S2_18_the_default_start_escapes_a_false_minimum) {
  PoseGraph graph = ring_with_a_turn_too_much();
  fix_first_pose(graph);
  PoseGraph trapped = graph;
  const auto plain =
      optimize_graph(trapped, {.start = GraphStart::file, .method = GraphMethod::gauss_newton});
  EXPECT_GT(plain.chi2_after, 100.0);
  EXPECT_EQ(loops_with_a_turn_too_much(trapped, Neighbours(trapped), placement_of(trapped)), 1U);
  PoseGraph warned = graph;
  EXPECT_LT(optimize_graph(warned, {.start = GraphStart::file}).chi2_after, 1e-4) << "others are tried, too";
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::converged);
  EXPECT_LT(summary.chi2_after, 1e-4);
  EXPECT_EQ(loops_with_a_turn_too_much(graph, Neighbours(graph), placement_of(graph)), 0U);
}

TEST(GraphOptimize, S2_19_whole_turns_in_headings_change_nothing) {
  const auto world = test_support::WorldMaker({}, 19).make();
  PoseGraph plain = world.graph;
  PoseGraph turned = placed(world.graph, world.truth);
  for (std::size_t v = 1; v < turned.vertices.size(); ++v)
    turned.vertices[v].yaw += 2.0 * math::kPi * (static_cast<double>(v % 7) - 3.0);
  for (GraphEdge& edge : turned.edges) edge.motion[2] += 2.0 * math::kPi;
  optimize_graph(plain, {.tolerance = 1e-20});
  optimize_graph(turned, {.start = GraphStart::file, .tolerance = 1e-20});
  EXPECT_LT(largest_difference(plain, turned), 1e-8);
}

TEST(GraphOptimize, S2_32_an_identity_on_one_vertex_gives_the_poses_of_a_fixed_one) {
  const auto world = test_support::WorldMaker({.poses = 40}, 32).make();
  PoseGraph fixed = world.graph;
  ASSERT_EQ(optimize_graph(fixed, {.tolerance = 1e-20}).state, GraphState::converged);
  // The noise of differences would push the first vertex, which nothing but the identity holds.
  const auto analytic = [](const GraphEdge& edge, const Placement& placement, std::size_t vertex) {
    const EdgeJacobians J = edge_jacobians(edge, placement);
    return vertex == edge.from ? J.from : J.to;
  };
  // Dense Gauss-Newton with the identity added to the first block, as the reference code does.
  Placement at = world.truth;
  for (int i = 0; i < 15; ++i) {
    auto dense = test_support::dense_system(world.graph, at, analytic);
    dense.hessian.topLeftCorner<3, 3>() += Eigen::Matrix3d::Identity();
    const Eigen::VectorXd step = dense.hessian.ldlt().solve(dense.b);
    for (std::size_t v = 0; v < at.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(3 * v);
      at[v] = {at[v].x + step[row], at[v].y + step[row + 1], math::wrap_angle(at[v].yaw + step[row + 2])};
    }
  }
  EXPECT_LT(largest_difference(fixed, placed(fixed, at)), 1e-9);
}

TEST(GraphOptimize, S2_32_refuses_without_an_anchor) {
  PoseGraph graph = graph_of(along_x(0, 1, 1.0));
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::no_gauge);
  EXPECT_FALSE(summary.is_usable());
  EXPECT_EQ(fix_first_pose(graph), 0U);
  EXPECT_EQ(optimize_graph(graph).state, GraphState::converged);
}

TEST(GraphOptimize, S2_33_headings_come_out_wrapped) {
  auto world = test_support::WorldMaker({}, 33).make();
  optimize_graph(world.graph);
  for (const GraphVertex& vertex : world.graph.vertices) {
    EXPECT_GT(vertex.yaw, -math::kPi);
    EXPECT_LE(vertex.yaw, math::kPi);
  }
}

TEST(GraphOptimize, anisotropic_information_neither_crawls_nor_traps) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    auto world = test_support::WorldMaker({.heading_sigma = 0.02, .anisotropic = true}, seed).make();
    PoseGraph from_truth = placed(world.graph, world.truth);
    const auto best = optimize_graph(from_truth, {.start = GraphStart::file});
    world.graph.has_positions = false;
    const auto summary = optimize_graph(world.graph);
    EXPECT_EQ(summary.state, GraphState::converged) << "seed " << seed;
    EXPECT_LE(summary.chi2_after, best.chi2_after * (1.0 + 1e-6)) << "seed " << seed;
    EXPECT_LT(summary.iterations.size(), 30U) << "seed " << seed;
  }
}

/// Mean distance between the vertices of two graphs, m.
double mean_distance(const PoseGraph& a, const PoseGraph& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.vertices.size(); ++i)
    sum += std::hypot(a.vertices[i].x - b.vertices[i].x, a.vertices[i].y - b.vertices[i].y);
  return sum / static_cast<double>(a.vertices.size());
}

TEST(RobustWeights, edges_that_are_off_by_far_more_than_they_say_hardly_count) {
  double plain_distance = 0.0, robust_distance = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    PoseGraph sound = test_support::WorldMaker({.poses = 200}, seed).make().graph;
    PoseGraph plain = sound;
    for (std::size_t e = 0, loop = 0; e < plain.edges.size(); ++e)
      if (plain.edges[e].to != plain.edges[e].from + 1 && loop++ % 10 == 0) plain.edges[e].motion[1] += 0.5;
    ASSERT_TRUE(optimize_graph(sound).is_usable() && optimize_graph(plain).is_usable());
    PoseGraph robust = plain;
    ASSERT_TRUE(settle_robustly(robust));
    plain_distance += mean_distance(plain, sound);
    robust_distance += mean_distance(robust, sound);
  }
  std::printf("20 worlds, from the graph without false edges: %.3f m, robustly %.3f m\n",
              plain_distance / 20.0, robust_distance / 20.0);
  EXPECT_LT(robust_distance, 0.5 * plain_distance);
}

TEST(RobustWeights, settling_again_moves_nothing_and_what_cannot_be_settled_stays) {
  PoseGraph graph = test_support::WorldMaker({.poses = 100}, 3).make().graph;
  ASSERT_TRUE(optimize_graph(graph).is_usable() && settle_robustly(graph));
  PoseGraph again = graph;
  ASSERT_TRUE(optimize_graph(again).is_usable());
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    EXPECT_NEAR(again.vertices[i].x, graph.vertices[i].x, 1e-6);
    EXPECT_NEAR(again.vertices[i].yaw, graph.vertices[i].yaw, 1e-6);
  }
  graph.vertices.front().fixed = false;  // no gauge
  const std::string before = to_g2o(graph);
  EXPECT_FALSE(settle_robustly(graph));
  EXPECT_EQ(to_g2o(graph), before);
}

TEST(GraphOptimize, the_same_input_gives_the_same_bits) {
  const auto world = test_support::WorldMaker({.anisotropic = true}, 3).make();
  PoseGraph first = world.graph;
  PoseGraph second = world.graph;
  optimize_graph(first);
  optimize_graph(second);
  EXPECT_EQ(to_g2o(first), to_g2o(second));
}

TEST(GraphOptimize, parts_that_do_not_hang_together_are_named) {
  PoseGraph graph = graph_of(along_x(0, 1, 1.0) + along_x(4, 5, 1.0));
  fix_first_pose(graph);
  const auto before = to_g2o(graph);
  const auto refused = optimize_graph(graph);
  EXPECT_EQ(refused.state, GraphState::not_connected);
  EXPECT_NE(refused.reason.find("pose 4"), std::string::npos) << refused.reason;
  EXPECT_NE(refused.reason.find("FIX 4"), std::string::npos) << refused.reason;
  EXPECT_EQ(to_g2o(graph), before);
  graph.vertices[2].fixed = true;
  EXPECT_EQ(optimize_graph(graph).state, GraphState::converged);
}

TEST(GraphOptimize, an_edge_without_information_connects_nothing) {
  PoseGraph graph = graph_of(along_x(0, 1, 1.0) + "EDGE_SE2 1 2 1 0 0 0 0 0 0 0 0\n" + along_x(2, 3, 1.0));
  fix_first_pose(graph);
  EXPECT_EQ(optimize_graph(graph).state, GraphState::not_connected);
}

TEST(GraphOptimize, a_direction_that_nothing_measures_is_singular) {
  PoseGraph graph = graph_of(along_x(0, 1, 1.0) + "EDGE_SE2 1 2 1 0 0 1 0 0 0 0 1\n");
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::singular);
  EXPECT_NE(summary.reason.find("pose 2"), std::string::npos) << summary.reason;
}

TEST(GraphOptimize, vertices_without_edges_stay_and_are_mentioned) {
  PoseGraph graph =
      graph_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\nVERTEX_SE2 7 5 6 1\n" + along_x(0, 1, 1.0));
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::converged);
  EXPECT_EQ(graph.vertices[2].x, 5.0);
  EXPECT_FALSE(graph.vertices[2].fixed);
  ASSERT_EQ(summary.notes.size(), 1U);
  EXPECT_NE(summary.notes[0].find("pose 7"), std::string::npos);
}

TEST(GraphOptimize, landmarks_that_nobody_saw_stay_and_are_mentioned) {
  PoseGraph graph =
      graph_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\nVERTEX_XY 7 5 6\n" + along_x(0, 1, 1.0));
  fix_first_pose(graph);
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::converged) << summary.reason;
  EXPECT_EQ(graph.vertices[2].x, 5.0);
  ASSERT_EQ(summary.notes.size(), 1U);
  EXPECT_NE(summary.notes[0].find("point 7"), std::string::npos);
}

/// Vertices anywhere within 100 m, to start from.
PoseGraph scattered(PoseGraph graph, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (GraphVertex& vertex : graph.vertices) {
    if (vertex.fixed) continue;
    vertex.x = 100.0 * uniform(engine);
    vertex.y = 100.0 * uniform(engine);
    if (vertex.kind == VertexKind::pose) vertex.yaw = math::kPi * uniform(engine);
  }
  return graph;
}

TEST(GraphOptimize, S2_18_random_worlds_end_at_one_chi2_from_every_start) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const test_support::WorldOptions options{
        .poses = 300, .anisotropic = seed % 2 == 0, .points = seed % 3 == 0 ? 20 : 0};
    const PoseGraph graph = scattered(test_support::WorldMaker(options, seed).make().graph, seed);
    PoseGraph first = graph;
    const GraphSummary best = optimize_graph(first);
    ASSERT_TRUE(best.is_usable()) << "seed " << seed << ": " << best.reason;
    for (const GraphStart start :
         {GraphStart::odometry, GraphStart::tree, GraphStart::rotations, GraphStart::file}) {
      PoseGraph other = graph;
      const GraphSummary summary = optimize_graph(other, {.start = start});
      EXPECT_TRUE(summary.is_usable()) << "seed " << seed << ": " << summary.reason;
      EXPECT_NEAR(summary.chi2_after, best.chi2_after, 1e-6 * best.chi2_after)
          << "seed " << seed << ", start " << static_cast<int>(start);
    }
  }
}

TEST(GraphOptimize, a_fixed_landmark_alone_leaves_a_rotation) {
  PoseGraph graph = graph_of(seen_ahead(0, 1, 2.0) + "FIX 1\n" + along_x(0, 2, 1.0));
  EXPECT_EQ(optimize_graph(graph).state, GraphState::not_connected);
}

TEST(GraphOptimize, two_fixed_landmarks_hold_a_pose) {
  PoseGraph graph = graph_of(
      "VERTEX_SE2 0 0.3 -0.2 0.4\nVERTEX_XY 1 2 0\nVERTEX_XY 2 0 2\nFIX 1 2\n"
      "EDGE_SE2_XY 0 1 2 0 1 0 1\nEDGE_SE2_XY 0 2 0 2 1 0 1\n");
  EXPECT_EQ(optimize_graph(graph).state, GraphState::converged);
  EXPECT_NEAR(graph.vertices[0].x, 0.0, 1e-6);
  EXPECT_NEAR(graph.vertices[0].yaw, 0.0, 1e-6);
}

TEST(GraphOptimize, a_graph_that_is_fixed_altogether_is_its_own_answer) {
  PoseGraph graph = graph_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 3 0 0\nFIX 0 1\n" + along_x(0, 1, 1.0));
  const auto summary = optimize_graph(graph);
  EXPECT_EQ(summary.state, GraphState::converged);
  EXPECT_NEAR(summary.chi2_after, 4.0, 1e-12);
  EXPECT_EQ(graph.vertices[1].x, 3.0);
}

TEST(GraphOptimize, numbers_beyond_reckoning_are_refused) {
  PoseGraph graph =
      graph_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1e200 0 0\nFIX 0\nEDGE_SE2 0 1 1 0 0 1e200 0 0 1 0 1\n");
  EXPECT_EQ(optimize_graph(graph, {.start = GraphStart::file, .method = GraphMethod::gauss_newton}).state,
            GraphState::not_finite);
  EXPECT_EQ(graph.vertices[1].x, 1e200);
}

TEST(GraphOptimize, says_when_the_iterations_run_out) {
  auto world = test_support::WorldMaker({}, 8).make();
  const auto before = to_g2o(world.graph);
  const auto summary = optimize_graph(
      world.graph, {.start = GraphStart::odometry, .method = GraphMethod::gauss_newton, .max_iterations = 1});
  EXPECT_EQ(summary.state, GraphState::iteration_limit);
  EXPECT_EQ(to_g2o(world.graph), before);
}

}  // namespace
}  // namespace odomcalib::calib::slam::graph_optimize_test
