#include "daemon/cli/graph_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "calib/slam/info.hpp"

namespace odomcalib::cli {
namespace {

constexpr double kSize = 1000.0;  // of the longer side, in units of the picture
constexpr double kPictureMargin = 20.0;
constexpr double kLegend = 30.0;  // height of the line of text below

/// From metres, y up, to the picture, y down.
class Frame {
 public:
  explicit Frame(const GraphVertex& first)
      : left_(first.x), right_(first.x), bottom_(first.y), top_(first.y) {}
  void include(const PoseGraph& graph) {
    for (const GraphVertex& vertex : graph.vertices) {
      left_ = std::min(left_, vertex.x);
      right_ = std::max(right_, vertex.x);
      bottom_ = std::min(bottom_, vertex.y);
      top_ = std::max(top_, vertex.y);
    }
  }
  void include(const Eigen::Vector2d& position) {
    left_ = std::min(left_, position.x());
    right_ = std::max(right_, position.x());
    bottom_ = std::min(bottom_, position.y());
    top_ = std::max(top_, position.y());
  }
  [[nodiscard]] double scale() const {
    const double side = std::max(right_ - left_, top_ - bottom_);
    return side > 0.0 ? kSize / side : 1.0;
  }
  [[nodiscard]] double width() const { return (right_ - left_) * scale() + 2.0 * kPictureMargin; }
  [[nodiscard]] double height() const { return (top_ - bottom_) * scale() + 2.0 * kPictureMargin; }
  [[nodiscard]] double x(const GraphVertex& vertex) const {
    return kPictureMargin + (vertex.x - left_) * scale();
  }
  [[nodiscard]] double y(const GraphVertex& vertex) const {
    return kPictureMargin + (top_ - vertex.y) * scale();
  }
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& position) const {
    return {kPictureMargin + (position.x() - left_) * scale(),
            kPictureMargin + (top_ - position.y()) * scale()};
  }

 private:
  double left_, right_, bottom_, top_;
};

std::string trajectory(const PoseGraph& graph, const Frame& frame, const char* id, const char* style) {
  std::string out = fmt::format("<polyline id=\"{}\" fill=\"none\" {} points=\"", id, style);
  for (const GraphVertex& vertex : graph.vertices)
    if (vertex.kind == VertexKind::pose)
      fmt::format_to(std::back_inserter(out), "{:.1f},{:.1f} ", frame.x(vertex), frame.y(vertex));
  return out + "\"/>\n";
}

std::string loop_edges(const PoseGraph& graph, const Frame& frame) {
  const auto odometry = calib::slam::odometry_edges(graph);
  std::string out = "<path id=\"loops\" fill=\"none\" stroke=\"#e08214\" stroke-width=\"0.8\" d=\"";
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphVertex& from = graph.vertices[graph.edges[k].from];
    const GraphVertex& to = graph.vertices[graph.edges[k].to];
    if (odometry[k] || to.kind == VertexKind::point) continue;
    fmt::format_to(std::back_inserter(out), "M{:.1f} {:.1f}L{:.1f} {:.1f}", frame.x(from), frame.y(from),
                   frame.x(to), frame.y(to));
  }
  return out + "\"/>\n";
}

std::string points(const PoseGraph& graph, const Frame& frame) {
  std::string out = "<g id=\"points\" fill=\"#222\">";
  for (const GraphVertex& vertex : graph.vertices)
    if (vertex.kind == VertexKind::point)
      fmt::format_to(std::back_inserter(out), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>",
                     frame.x(vertex), frame.y(vertex));
  return out + "</g>\n";
}

/// A small square for every cell.
std::string cells(const PictureMap& map, const Frame& frame) {
  const double side = std::max(map.cell * frame.scale(), 0.7);  // a thinner one would fade
  std::string out = "<path id=\"map\" fill=\"#c51b8a\" d=\"";
  for (const Eigen::Vector2d& centre : map.occupied) {
    const Eigen::Vector2d corner = frame.at(centre) - Eigen::Vector2d::Constant(0.5 * side);
    fmt::format_to(std::back_inserter(out), "M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}z", corner.x(), corner.y(),
                   side, side, -side);
  }
  return out + "\"/>\n";
}

std::string rays(const PictureMap& map, const GraphVertex& eye, const Frame& frame) {
  std::string out = "<path id=\"rays\" fill=\"none\" stroke=\"#9acd32\" stroke-width=\"0.3\" d=\"";
  for (const Eigen::Vector2d& seen : map.last_scan) {
    const Eigen::Vector2d end = frame.at(seen);
    fmt::format_to(std::back_inserter(out), "M{:.1f} {:.1f}L{:.1f} {:.1f}", frame.x(eye), frame.y(eye),
                   end.x(), end.y());
  }
  return out + "\"/>\n";
}

std::string scan(const PictureMap& map, const Frame& frame) {
  std::string out = "<g id=\"scan\" fill=\"#1a9641\">";
  for (const Eigen::Vector2d& seen : map.last_scan) {
    const Eigen::Vector2d end = frame.at(seen);
    fmt::format_to(std::back_inserter(out), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.5\"/>", end.x(),
                   end.y());
  }
  return out + "</g>\n";
}

const GraphVertex& last_pose(const PoseGraph& graph) {
  return *std::find_if(graph.vertices.rbegin(), graph.vertices.rend(),
                       [](const GraphVertex& v) { return v.kind == VertexKind::pose; });
}

std::string legend(const Frame& frame) {
  return fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\" font-family=\"sans-serif\" font-size=\"14\">"
      "<tspan fill=\"#888\">before</tspan> <tspan fill=\"#2166ac\">after</tspan> "
      "<tspan fill=\"#e08214\">loops</tspan> 1 m = {:.3g} px</text>\n",
      kPictureMargin, frame.height() + 0.5 * kLegend, frame.scale());
}

}  // namespace

std::string graph_picture(const PoseGraph& before, const PoseGraph& after, const PictureMap& map) {
  Frame frame(after.vertices.front());
  frame.include(before);
  frame.include(after);
  for (const Eigen::Vector2d& centre : map.occupied) frame.include(centre);
  for (const Eigen::Vector2d& seen : map.last_scan) frame.include(seen);
  return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\">\n",
                     frame.width(), frame.height() + kLegend) +
         (map.occupied.empty() ? ""
                               : rays(map, last_pose(after), frame) + cells(map, frame) + scan(map, frame)) +
         trajectory(before, frame, "before", "stroke=\"#888\" stroke-dasharray=\"3 2\"") +
         loop_edges(after, frame) +
         trajectory(after, frame, "after", "stroke=\"#2166ac\" stroke-width=\"1.5\"") + points(after, frame) +
         legend(frame) + "</svg>\n";
}

}  // namespace odomcalib::cli
