// Public pose graphs, which are not part of the repository. The best known chi2 of each is that of a
// certified global optimum of the chordal cost, refined.
#include <gtest/gtest.h>

#include <sstream>

#include "calib/slam/connectivity.hpp"
#include "calib/slam/optimize.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::calib::slam::graph_public_test {
namespace {

struct Known {
  const char* name;
  double chi2_file;
  double chi2_best;
};

void PrintTo(const Known& known, std::ostream* out) { *out << known.name; }

std::filesystem::path path_of(const std::string& name) {
  return odomcalib::test_support::shared_data("posegraph/" + name + ".g2o.gz");
}

PoseGraph graph_of(const std::string& name) {
  const std::vector<std::filesystem::path> files{path_of(name)};
  auto graph = read_pose_graph(files);
  EXPECT_TRUE(graph.ok());
  return graph.ok() ? std::move(graph).value() : PoseGraph{};
}

void place_along_tree(PoseGraph& graph) {
  const auto tree = spanning_tree(graph, Neighbours(graph), TreeKind::breadth_first);
  const Placement at = placed_along(graph, tree, placement_of(graph));
  for (std::size_t v = 0; v < at.size(); ++v) {
    graph.vertices[v].x = at[v].x;
    graph.vertices[v].y = at[v].y;
    graph.vertices[v].yaw = at[v].yaw;
  }
}

class PublicGraph : public ::testing::TestWithParam<Known> {};

TEST_P(PublicGraph, S2_18_ends_at_the_best_known_chi2_whatever_the_vertices_were) {
  ODOMCALIB_NEEDS_SHARED(std::string("posegraph/") + GetParam().name + ".g2o.gz");
  const PoseGraph original = graph_of(GetParam().name);
  EXPECT_NEAR(graph_chi2(original), GetParam().chi2_file, 1e-5 * GetParam().chi2_file);
  for (const auto start : {GraphStart::file, GraphStart::odometry, GraphStart::tree, GraphStart::rotations}) {
    PoseGraph graph = original;
    fix_first_pose(graph);
    // The vertices as a file with this first guess would have them.
    if (start == GraphStart::odometry) place_along_odometry(graph);
    if (start == GraphStart::tree) place_along_tree(graph);
    if (start == GraphStart::rotations) graph.has_positions = false;
    const auto summary = optimize_graph(graph);
    EXPECT_EQ(summary.state, GraphState::converged);
    EXPECT_LE(summary.iterations.size(), 5U);
    EXPECT_NEAR(summary.chi2_after, GetParam().chi2_best, 1e-8 * GetParam().chi2_best);
    EXPECT_NEAR(graph_chi2(graph), summary.chi2_after, 1e-9 * summary.chi2_after);
  }
}

INSTANTIATE_TEST_SUITE_P(Graphs, PublicGraph,
                         ::testing::Values(Known{"killian", 308592078.544, 10344.665262},
                                           Known{"killian-smallrot", 178252738.893, 106.266009},
                                           Known{"intel", 551.735731, 45.0046958},
                                           Known{"M3500", 2566667.659, 137.912951},
                                           Known{"MIT", 4414181663.0, 41.1632688},
                                           Known{"city10000", 654162688.0, 511.985164}),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           std::erase(name, '-');
                           return name;
                         });

TEST(PublicGraphs, S2_18_plain_gauss_newton_from_odometry_is_trapped_where_it_is_known_to_be) {
  ODOMCALIB_NEEDS_SHARED("posegraph/MIT.g2o.gz");
  PoseGraph graph = graph_of("MIT");
  fix_first_pose(graph);
  const auto summary =
      optimize_graph(graph, {.start = GraphStart::odometry, .method = GraphMethod::gauss_newton});
  EXPECT_NEAR(summary.chi2_after, 770.6635, 0.001);
}

/// The same graph in the old order, as the public file of that time has it.
std::string in_the_old_order(const PoseGraph& graph, const char* edge_tag) {
  std::ostringstream text;
  text.precision(17);
  for (const GraphVertex& v : graph.vertices)
    text << "VERTEX2 " << v.id << ' ' << v.x << ' ' << v.y << ' ' << v.yaw << '\n';
  for (const GraphEdge& edge : graph.edges) {
    const auto& i = edge.information;
    text << edge_tag << ' ' << graph.vertices[edge.from].id << ' ' << graph.vertices[edge.to].id;
    for (const double number :
         {edge.motion[0], edge.motion[1], edge.motion[2], i[0], i[1], i[3], i[5], i[2], i[4]})
      text << ' ' << number;
    text << '\n';
  }
  return text.str();
}

TEST(PublicGraphs, S2_37_killian_in_the_old_order) {
  ODOMCALIB_NEEDS_SHARED("posegraph/killian.g2o.gz");
  const PoseGraph original = graph_of("killian");
  for (const char* tag : {"EDGE2", "EDGE"}) {
    auto graph = read_pose_graph_text(in_the_old_order(original, tag), "killian");
    ASSERT_TRUE(graph.ok()) << graph.error().text();
    fix_first_pose(graph.value());
    EXPECT_NEAR(optimize_graph(graph.value()).chi2_after, 10344.6653, 1e-4);
  }
  EXPECT_FALSE(read_pose_graph_text(in_the_old_order(original, "EDGE_SE2"), "killian").ok());
}

}  // namespace
}  // namespace odomcalib::calib::slam::graph_public_test
