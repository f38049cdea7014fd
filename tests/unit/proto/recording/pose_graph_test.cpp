// g2o and TORO text.
#include "proto/recording/pose_graph.hpp"

#include <random>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::pose_graph_test {
namespace {

constexpr const char* kTwoPoses = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";

PoseGraph good(const std::string& text) {
  auto graph = read_pose_graph_text(text, "test");
  EXPECT_TRUE(graph.ok()) << (graph.ok() ? "" : graph.error().text());
  return graph.ok() ? std::move(graph).value() : PoseGraph{};
}

std::string refusal(const std::string& text) {
  const auto graph = read_pose_graph_text(text, "test");
  if (graph.ok()) return "was accepted";
  EXPECT_EQ(graph.error().code, ErrorCode::format);
  return graph.error().text();
}

TEST(PoseGraphText, S2_36_reads_all_vertex_tags_with_ids_in_any_order) {
  const auto graph = good("VERTEX 9 1 2 3\nVERTEX2 -4 1 2 3\n# comment\n\nVERTEX_SE2 7 +1 2e0 .3e1 \r\n");
  ASSERT_EQ(graph.vertices.size(), 3U);
  EXPECT_EQ(graph.vertices[1].id, -4);
  for (const GraphVertex& vertex : graph.vertices) {
    EXPECT_EQ(vertex.x, 1.0);
    EXPECT_EQ(vertex.y, 2.0);
    EXPECT_EQ(vertex.yaw, 3.0);
  }
}

TEST(PoseGraphText, S2_37_SD_17_the_tag_decides_the_order_of_the_information) {
  const std::array<double, 6> expected{10, 1, 2, 20, 3, 30};  // xx xy xt yy yt tt
  const std::string vertices = kTwoPoses;
  EXPECT_EQ(good(vertices + "EDGE_SE2 0 1 1 0 0 10 1 2 20 3 30\n").edges[0].information, expected);
  EXPECT_EQ(good(vertices + "EDGE2 0 1 1 0 0 10 1 20 30 2 3\n").edges[0].information, expected);
  EXPECT_EQ(good(vertices + "EDGE 0 1 1 0 0 10 1 20 30 2 3\n").edges[0].information, expected);
}

TEST(PoseGraphText, S2_37_the_wrong_order_is_refused_with_a_hint) {
  const std::string told = refusal(std::string(kTwoPoses) + "EDGE_SE2 0 1 1 0 0 20 0 20 100000 0 0\n");
  EXPECT_NE(told.find("test:3"), std::string::npos) << told;
  EXPECT_NE(told.find("xx xy yy tt xt yt"), std::string::npos) << told;
  // The other way round, as in the comment of the reference code.
  EXPECT_NE(refusal(std::string(kTwoPoses) + "EDGE2 0 1 1 0 0 115 -9.9 -7.1 347 185 225\n").find("positive"),
            std::string::npos);
}

TEST(PoseGraphText, S2_12_information_that_is_no_inverse_covariance_is_refused) {
  const auto with = [](const std::string& information) {
    return std::string(kTwoPoses) + "EDGE_SE2 0 1 1 0 0 " + information + "\n";
  };
  EXPECT_NE(refusal(with("-1 0 0 1 0 1")).find("0 -> 1"), std::string::npos);
  EXPECT_NE(refusal(with("1 1.001 0 1 0 1")).find("positive"), std::string::npos);
  EXPECT_NE(refusal(with("1 0.9 0.9 1 -0.9 1")).find("positive"), std::string::npos);
  EXPECT_NE(refusal(with("1 0 1e-3 1 0 0")).find("positive"), std::string::npos);
  good(with("1 0.999 0 1 0 1"));
  good(with("1 1 0 1 0 1"));  // singular is allowed, one direction is unknown
  good(with("0 0 0 0 0 0"));
}

TEST(PoseGraphText, S2_10_reads_landmarks) {
  const auto graph = good("EDGE_SE2_XY 0 5 1 2 4 1 9\nVERTEX_SE2 0 0 0 0\nVERTEX_XY 5 1 2\nFIX 0\n");
  EXPECT_EQ(graph.vertices[1].kind, VertexKind::point);
  EXPECT_EQ(graph.edges[0].information, (std::array<double, 6>{4, 1, 0, 9, 0, 0}));
  EXPECT_EQ(graph.edges[0].from, 0U);
  EXPECT_EQ(graph.edges[0].to, 1U);
  EXPECT_TRUE(graph.vertices[0].fixed);
}

TEST(PoseGraphText, edges_alone_make_their_vertices_in_the_order_of_ids) {
  const auto graph = good("EDGE_SE2 7 3 1 0 0 1 0 0 1 0 1\nEDGE_SE2_XY 3 1 1 0 1 0 1\n");
  EXPECT_FALSE(graph.has_positions);
  ASSERT_EQ(graph.vertices.size(), 3U);
  EXPECT_EQ(graph.vertices[0].id, 1);
  EXPECT_EQ(graph.vertices[0].kind, VertexKind::point);
  EXPECT_EQ(graph.vertices[2].id, 7);
}

TEST(PoseGraphText, what_cannot_be_used_is_refused_with_its_line) {
  const std::string two = kTwoPoses;
  const std::vector<std::pair<std::string, std::string>> cases{
      {two + "VERTEX_SE2 1 0 0 0\n", "test:3: vertex 1 was already at test:2"},
      {two + "EDGE_SE2 0 2 1 0 0 1 0 0 1 0 1\n", "test:3: names vertex 2"},
      {two + "EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n", "joins a vertex to itself"},
      {two + "EDGE_SE2 0 1 nan 0 0 1 0 0 1 0 1\n", "test:3: \"nan\" is no finite number"},
      {two + "EDGE_SE2 0 1 1e999 0 0 1 0 0 1 0 1\n", "\"1e999\" is no finite number"},
      {two + "EDGE_SE2 0 1.5 1 0 0 1 0 0 1 0 1\n", "\"1.5\" is no vertex number"},
      {two + "EDGE_SE2 0 99999999999999999999 1 0 0 1 0 0 1 0 1\n", "is no vertex number"},
      {two + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0", "ends after 10"},
      {two + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 7\n", "this line has more"},
      {two + "EDGE_SE2_XY 0 1 1 0 1 0 1\n", "does not fit the kind"},
      {two + "FIX\n", "FIX without"},
      {two + "FIX 5\n", "test:3: names vertex 5"},
      {"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "no planar vertex"},
      {"", "no vertex and no edge"},
      {"nothing of the kind\n", "no vertex and no edge"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(refusal(text).find(expected), std::string::npos) << text << refusal(text);
}

TEST(PoseGraphText, other_lines_are_skipped_and_counted) {
  const auto graph = good(std::string(kTwoPoses) + "PARAMS_SE2OFFSET 0 0 0 0\nPARAMS_SE2OFFSET 1 0 0 0\n");
  ASSERT_EQ(graph.notes.size(), 1U);
  EXPECT_EQ(graph.notes[0], "skipped 2 lines \"PARAMS_SE2OFFSET\"");
}

TEST(PoseGraphText, numbers_that_are_one_place_become_one_vertex) {
  const std::string edges =
      "EDGE2 0 1 1 0 0 500 0 500 5000 0 0\nEDGE2 3 1 2 0 0 500 0 500 5000 0 0\n"
      "EDGE2 2 4 0 0 0 500 0 500 5000 0 0\nFIX 4\n";
  const std::string vertices =
      "VERTEX2 0 0 0 0\nVERTEX2 2 1 2 3\nVERTEX2 1 1 0 0\nVERTEX2 4 5 0 0\nVERTEX2 3 6 0 0\n";
  // In any order and by way of a third number.
  const std::vector<std::string> texts{"EQUIV 3 4\nEQUIV 4 2\n" + vertices + edges,
                                       vertices + edges + "EQUIV 2 3\nEQUIV 3 4\nEQUIV 4 2\nEQUIV 2 2\n"};
  for (const std::string& text : texts) {
    const auto graph = good(text);
    ASSERT_EQ(graph.vertices.size(), 3U) << text;
    EXPECT_EQ(graph.vertices[1].id, 2);
    EXPECT_EQ(graph.vertices[1].yaw, 3.0) << "the first of the file says where it starts";
    EXPECT_TRUE(graph.vertices[1].fixed);
    ASSERT_EQ(graph.aliases.size(), 2U);
    EXPECT_EQ(graph.aliases[0].id, 4);
    EXPECT_EQ(graph.aliases[1].vertex, 1U);
    ASSERT_EQ(graph.edges.size(), 2U) << "an edge within one place says nothing about the others";
    EXPECT_EQ(graph.edges[1].from, 1U);
    EXPECT_EQ(graph.edges[1].to, 2U);
    const auto again = good(to_g2o(graph));
    EXPECT_EQ(to_g2o(again), to_g2o(graph));
    EXPECT_EQ(again.aliases.size(), 2U);
    ASSERT_EQ(graph.notes.size(), 2U);
    EXPECT_EQ(graph.notes[0], "EQUIV: 2 vertex numbers name the place of another vertex, the first: 4 is 2");
  }
  EXPECT_NE(refusal(vertices + "EQUIV 2 9\n").find("test:6: names vertex 9"), std::string::npos);
  EXPECT_NE(refusal(vertices + "EQUIV 2\n").find("ends after 1"), std::string::npos);
  EXPECT_NE(refusal("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 0 0\nEQUIV 0 1\n").find("a landmark"),
            std::string::npos);
}

TEST(PoseGraphText, a_byte_order_mark_is_no_part_of_the_first_line) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::string edge = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  for (const std::string& text : {kTwoPoses + edge, edge, "# made by an editor\r\n" + (kTwoPoses + edge)}) {
    const auto graph = good(mark + text);
    EXPECT_EQ(graph.vertices.size(), 2U) << text;
    EXPECT_EQ(graph.edges.size(), 1U) << text;
    EXPECT_TRUE(graph.notes.empty()) << text;
  }
  const auto vertices = test::write_file("mark-v.g2o", mark + kTwoPoses);
  const auto edges = test::write_file("mark-e.g2o", mark + edge);
  const std::vector<std::filesystem::path> files{vertices, edges};
  EXPECT_TRUE(value_of(read_pose_graph(files)).notes.empty());
  using namespace std::string_literals;
  EXPECT_NE(refusal("\xFF\xFEV\0E\0"s).find("UTF-16"), std::string::npos);
}

TEST(PoseGraphText, vertices_and_edges_of_other_kinds_are_refused_by_name) {
  const std::string other =
      "TUTORIAL_VERTEX_SE2 5 1 1 0\nTUTORIAL_VERTEX_SE2 6 1 1 0\nCustomEdge 1 5 1 0 0\n";
  for (const std::string& text : {other, kTwoPoses + other}) {
    const std::string told = refusal("PARAMS 1\n" + text);
    EXPECT_NE(told.find("\"TUTORIAL_VERTEX_SE2\" (2 lines), \"CustomEdge\" (1 line)"), std::string::npos)
        << told;
    EXPECT_NE(told.find(text == other ? "test:2" : "test:4"), std::string::npos) << told;
  }
  EXPECT_NE(refusal("BEAM 1\nBEAM 2\n").find("no vertex and no edge; other lines: \"BEAM\" (2 lines)"),
            std::string::npos);
}

TEST(PoseGraphText, S2_05_writing_and_reading_loses_nothing) {
  constexpr unsigned kSeed = 5;
  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::string text = "VERTEX_XY 1000 0.1 -1e-300\nFIX 3 1000\n";
  for (int i = 0; i < 100; ++i)
    text += "VERTEX_SE2 " + std::to_string(i) + " " + std::to_string(1e6 * number(engine)) + " 0.1 " +
            std::to_string(3.0 * number(engine)) + "\nEDGE_SE2 " + std::to_string(i) + " " +
            std::to_string((i + 1) % 100) + " 1 2 3 4 0.1 0.2 5 0.3 6\n";
  text += "EDGE_SE2_XY 4 1000 0.3333333333333333 1 2 0.1 3\n";
  const auto first = good(text);
  const auto second = good(to_g2o(first));
  EXPECT_EQ(to_g2o(first), to_g2o(second)) << "seed " << kSeed;
  ASSERT_EQ(first.vertices.size(), second.vertices.size());
  for (std::size_t v = 0; v < first.vertices.size(); ++v) {
    EXPECT_EQ(first.vertices[v].x, second.vertices[v].x);
    EXPECT_EQ(first.vertices[v].y, second.vertices[v].y);
    EXPECT_EQ(first.vertices[v].yaw, second.vertices[v].yaw);
    EXPECT_EQ(first.vertices[v].fixed, second.vertices[v].fixed);
  }
  ASSERT_EQ(first.edges.size(), second.edges.size());
  for (std::size_t k = 0; k < first.edges.size(); ++k) {
    EXPECT_EQ(first.edges[k].motion, second.edges[k].motion);
    EXPECT_EQ(first.edges[k].information, second.edges[k].information);
  }
}

TEST(PoseGraphText, S2_33_headings_are_written_within_half_a_turn) {
  const auto graph = good(to_g2o(good("VERTEX_SE2 0 0 0 7\nVERTEX_SE2 1 0 0 -3.141592653589793\n")));
  EXPECT_NEAR(graph.vertices[0].yaw, 7.0 - 6.283185307179586, 1e-15);
  EXPECT_GT(graph.vertices[1].yaw, 0.0);
}

TEST(PoseGraphText, S2_35_vertices_and_edges_may_be_files_of_their_own_packed_or_not) {
  const auto vertices = test::write_file("graph-v.dat", "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\n");
  const auto edges = test::write_file("graph-e.dat.gz", gzip("EDGE 1 0 -1 0 0 20 0 20 100 0 0\n").value());
  const std::vector<std::filesystem::path> files{vertices, edges};
  const auto graph = value_of(read_pose_graph(files));
  EXPECT_EQ(graph.edges[0].information, (std::array<double, 6>{20, 0, 0, 20, 0, 100}));
}

TEST(PoseGraphText, a_packed_file_without_its_end_is_refused) {
  const std::string packed = gzip(std::string(10000, '#') + "\n" + kTwoPoses).value();
  const auto path = test::write_file("cut.g2o.gz", packed.substr(0, packed.size() - 12));
  const std::vector<std::filesystem::path> files{path};
  const auto graph = read_pose_graph(files);
  ASSERT_FALSE(graph.ok());
  EXPECT_EQ(graph.error().code, ErrorCode::format);
}

}  // namespace
}  // namespace odomcalib::pose_graph_test
