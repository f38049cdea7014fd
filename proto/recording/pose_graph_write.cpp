// g2o text; always the current tags and order, whatever was read.
#include <charconv>
#include <cmath>
#include <numbers>

#include "proto/recording/pose_graph.hpp"

namespace odomcalib {
namespace {

constexpr std::size_t kLongestNumber = 32;  // shortest form of a double has at most 24 characters

template <typename Number>
void append_number(std::string& text, Number number) {
  std::array<char, kLongestNumber> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  text += ' ';
  text.append(buffer.data(), end.ptr);
}

/// Only what is outside is touched, so that reading and writing leaves every heading as it was.
double heading(double yaw) {
  constexpr double kPi = std::numbers::pi;
  if (yaw > -kPi && yaw <= kPi) return yaw;
  const double within = std::remainder(yaw, 2.0 * kPi);
  return within > -kPi ? within : kPi;
}

void append_vertex(std::string& text, const GraphVertex& vertex) {
  const bool pose = vertex.kind == VertexKind::pose;
  text += pose ? "VERTEX_SE2" : "VERTEX_XY";
  append_number(text, vertex.id);
  append_number(text, vertex.x);
  append_number(text, vertex.y);
  if (pose) append_number(text, heading(vertex.yaw));
  text += '\n';
}

void append_edge(std::string& text, const PoseGraph& graph, const GraphEdge& edge) {
  const auto& [xx, xy, xt, yy, yt, tt] = edge.information;
  const bool pose = graph.vertices[edge.to].kind == VertexKind::pose;
  text += pose ? "EDGE_SE2" : "EDGE_SE2_XY";
  append_number(text, graph.vertices[edge.from].id);
  append_number(text, graph.vertices[edge.to].id);
  append_number(text, edge.motion[0]);
  append_number(text, edge.motion[1]);
  if (pose)
    for (const double number : {heading(edge.motion[2]), xx, xy, xt, yy, yt, tt}) append_number(text, number);
  else
    for (const double number : {xx, xy, yy}) append_number(text, number);
  text += '\n';
}

}  // namespace

std::string to_g2o(const PoseGraph& graph) {
  std::string text;
  for (const GraphVertex& vertex : graph.vertices) append_vertex(text, vertex);
  for (const GraphAlias& alias : graph.aliases) {
    GraphVertex same = graph.vertices[alias.vertex];
    same.id = alias.id;
    append_vertex(text, same);
  }
  for (const GraphAlias& alias : graph.aliases) {
    text += "EQUIV";
    append_number(text, graph.vertices[alias.vertex].id);
    append_number(text, alias.id);
    text += '\n';
  }
  for (const GraphVertex& vertex : graph.vertices) {
    if (!vertex.fixed) continue;
    text += "FIX";
    append_number(text, vertex.id);
    text += '\n';
  }
  for (const GraphEdge& edge : graph.edges) append_edge(text, graph, edge);
  return text;
}

}  // namespace odomcalib
