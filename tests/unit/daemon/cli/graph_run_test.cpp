// Pose graphs on the command line: what is told and drawn.
#include "daemon/cli/graph_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "daemon/cli/graph_picture.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::graph_run_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSquare =
    "EDGE_SE2 0 1 1 0 1.6 100 0 0 100 0 400\nEDGE_SE2 1 2 1 0 1.6 100 0 0 100 0 400\n"
    "EDGE_SE2 2 3 1 0 1.5 100 0 0 100 0 400\nEDGE_SE2 3 0 1 0 1.57 100 0 0 100 0 400\n"
    "EDGE_SE2_XY 0 9 2 1 4 0 4\n";

GraphRun square() {
  auto graph = read_pose_graph_text(kSquare, "square");
  EXPECT_TRUE(graph.ok());
  return run_graph(std::move(graph).value(), {});
}

TEST(GraphRun, S2_21_tells_chi2_with_six_digits_and_every_iteration) {
  const GraphRun run = square();
  ASSERT_TRUE(run.summary.is_usable());
  const std::string text = to_text(describe(run));
  char chi2[64];
  std::snprintf(chi2, sizeof chi2, "%.6f after: converged", run.summary.chi2_after);
  EXPECT_THAT(text, HasSubstr(chi2));
  EXPECT_THAT(text, HasSubstr("lambda"));
  const auto json = to_json(run);
  EXPECT_EQ(json["state"], "converged");
  EXPECT_GT(json["chi2_before"].get<double>(), json["chi2_after"].get<double>());
  EXPECT_EQ(json["iterations"].size(), run.iterations.size());
  EXPECT_FALSE(run.iterations.empty());
  EXPECT_EQ(json["degrees_of_freedom"], 3);
}

TEST(GraphRun, S2_32_says_which_vertex_it_kept_and_leaves_no_mark_in_the_file) {
  const GraphRun run = square();
  EXPECT_EQ(run.fixed, std::vector<std::int64_t>{0});
  EXPECT_THAT(to_text(describe(run)), HasSubstr("pose 0 is kept where it is"));
  EXPECT_THAT(to_g2o(run.after), Not(HasSubstr("FIX")));
}

TEST(GraphRun, S2_34_draws_both_trajectories_and_the_loops_in_one_frame) {
  const GraphRun run = square();
  const std::string picture = graph_picture(run.before, run.after);
  EXPECT_THAT(picture, HasSubstr("<polyline id=\"before\""));
  EXPECT_THAT(picture, HasSubstr("<polyline id=\"after\""));
  EXPECT_THAT(picture, HasSubstr("id=\"loops\" fill=\"none\" stroke=\"#e08214\" stroke-width=\"0.8\" d=\"M"));
  EXPECT_THAT(picture, HasSubstr("<circle"));
  EXPECT_NE(picture.find("</svg>"), std::string::npos);
  // The first pose is at the same place in both.
  const auto first_of = [&picture](const std::string& id) {
    const auto begin = picture.find("points=\"", picture.find("id=\"" + id + "\"")) + 8;
    return picture.substr(begin, picture.find(' ', begin) - begin);
  };
  EXPECT_EQ(first_of("before"), first_of("after"));
}

TEST(GraphRun, S2_39_draws_map_scan_path_and_rays) {
  const GraphRun run = square();
  const PictureMap map{{{0.5, 0.5}}, 0.05, {{0.5, 0.5}, {0.2, 1.4}}};
  const std::string picture = graph_picture(run.before, run.after, map);
  const auto layer = [&picture](const std::string& id) { return picture.find("id=\"" + id + "\""); };
  for (const char* id : {"map", "scan", "after", "rays"}) ASSERT_NE(layer(id), std::string::npos) << id;
  EXPECT_LT(layer("rays"), layer("map")) << "rays would hide the walls";
  EXPECT_LT(layer("scan"), layer("after"));
  const std::string rays = picture.substr(layer("rays"), picture.find("/>", layer("rays")) - layer("rays"));
  EXPECT_EQ(std::count(rays.begin(), rays.end(), 'M'), 2);
  EXPECT_THAT(graph_picture(run.before, run.after), Not(HasSubstr("id=\"rays\"")));
}

TEST(GraphRun, S2_05_what_is_written_is_read_back_and_is_at_its_optimum) {
  const GraphRun run = square();
  auto again = value_of(read_pose_graph_text(to_g2o(run.after), "again"));
  EXPECT_DOUBLE_EQ(calib::slam::graph_chi2(again), run.summary.chi2_after);
  EXPECT_NEAR(run_graph(std::move(again), {}).summary.chi2_after, run.summary.chi2_after,
              1e-9 * run.summary.chi2_after);
}

TEST(GraphRun, one_point_in_space_can_be_drawn) {
  auto graph = value_of(read_pose_graph_text("VERTEX_SE2 0 5 5 0\n", "one"));
  EXPECT_THAT(graph_picture(graph, graph), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace odomcalib::cli::graph_run_test
