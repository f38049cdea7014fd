// Pose graphs: whatever is accepted has finite numbers, edges between its own vertices, and survives writing.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "proto/recording/pose_graph.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const odomcalib::PoseGraph& graph) {
  for (const auto& vertex : graph.vertices)
    require(std::isfinite(vertex.x) && std::isfinite(vertex.y) && std::isfinite(vertex.yaw));
  for (const auto& edge : graph.edges) {
    require(edge.from < graph.vertices.size() && edge.to < graph.vertices.size() && edge.from != edge.to);
    require(graph.vertices[edge.from].kind == odomcalib::VertexKind::pose);
    for (const double number : edge.motion) require(std::isfinite(number));
    for (const double number : edge.information) require(std::isfinite(number));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto graph = odomcalib::read_pose_graph_text({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!graph.ok()) return 0;
  check(graph.value());
  const std::string text = odomcalib::to_g2o(graph.value());
  const auto again = odomcalib::read_pose_graph_text(text, "written");
  require(again.ok());
  require(odomcalib::to_g2o(again.value()) == text);
  return 0;
}
