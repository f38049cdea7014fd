#include "daemon/safety/clear_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "daemon/routines/motion.hpp"
#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {
namespace {

/// The required space as a box, m in the base frame.
struct Box {
  double back = 0.0, front = 0.0, right = 0.0, left = 0.0;
};

Box box_of(const std::vector<routines::Pose>& poses, const Footprint& footprint, double clearance) {
  Box box;
  const double front = footprint.front + clearance, back = footprint.back + clearance;
  const double half_width = footprint.half_width + clearance;
  for (const auto& pose : poses) {
    const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
    for (const double along : {front, -back})
      for (const double across : {half_width, -half_width}) {
        const double x = pose.x + along * c - across * s, y = pose.y + along * s + across * c;
        box = {std::min(box.back, x), std::max(box.front, x), std::min(box.right, y), std::max(box.left, y)};
      }
  }
  return box;
}

// Nearest reading ahead, to the left, behind and to the right, beside nothing but the lane of the robot.
std::optional<double> nearest(const std::vector<Point>& points, const Footprint& footprint, double clearance,
                              std::size_t side) {
  std::optional<double> found;
  for (const Point& point : points) {
    if (inside(point, footprint, 0.0)) continue;
    const std::array<double, 4> towards = {point.x, point.y, -point.x, -point.y};
    const bool along = side % 2 == 0;
    const bool in_lane =
        along ? std::abs(point.y) <= footprint.half_width + clearance
              : point.x <= footprint.front + clearance && point.x >= -footprint.back - clearance;
    if (in_lane && towards.at(side) > 0.0 && (!found || towards.at(side) < *found)) found = towards.at(side);
  }
  return found;
}

class Map {
 public:
  Map(const Box& box, double cell) : cell_(cell) {
    front_ = cells(box.front + settings::kMapMargin_m);
    left_ = cells(box.left + settings::kMapMargin_m);
    const int rows = front_ + cells(settings::kMapMargin_m - box.back) + 1;
    const int columns = left_ + cells(settings::kMapMargin_m - box.right) + 1;
    rows_.assign(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(columns), ' '));
  }
  /// Marks what `is_of` takes of the cells that are not marked yet, within `reach` m of a place: a way is
  /// long, and a robot is small.
  template <typename IsOf>
  void fill(const Point& place, double reach, char character, IsOf is_of) {
    const int row = front_ - static_cast<int>(std::lround(place.x / cell_));
    const int column = left_ - static_cast<int>(std::lround(place.y / cell_));
    const int around = cells(reach) + 1;
    for (int i = std::max(0, row - around); i <= std::min(last_row(), row + around); ++i)
      for (int j = std::max(0, column - around); j <= std::min(last_column(), column + around); ++j)
        if (char& cell = at(i, j); cell == ' ' && is_of(Point{(front_ - i) * cell_, (left_ - j) * cell_}))
          cell = character;
  }
  void mark(const Point& point, char character) {
    const auto row = static_cast<std::size_t>(front_ - std::lround(point.x / cell_));
    const auto column = static_cast<std::size_t>(left_ - std::lround(point.y / cell_));
    if (row < rows_.size() && column < rows_[row].size()) rows_[row][column] = character;
  }
  [[nodiscard]] const std::vector<std::string>& rows() const { return rows_; }

 private:
  [[nodiscard]] int last_row() const { return static_cast<int>(rows_.size()) - 1; }
  [[nodiscard]] int last_column() const { return static_cast<int>(rows_.front().size()) - 1; }
  [[nodiscard]] char& at(int row, int column) {
    return rows_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  }
  [[nodiscard]] int cells(double length) const { return static_cast<int>(std::ceil(length / cell_)); }

  double cell_;
  int front_ = 0, left_ = 0;  // cells from the middle of the axle to the edge
  std::vector<std::string> rows_;
};

}  // namespace

ClearSpace clear_space(const std::vector<Point>& points, const routines::Preview& preview,
                       const Footprint& footprint, double clearance) {
  const Box box = box_of(preview.path, footprint, clearance);
  const double widest = std::max(box.front - box.back, box.left - box.right);
  ClearSpace space;
  space.cell = std::max(settings::kMapCell_m, widest / settings::kMapCells);
  Map map(box, space.cell);
  map.fill({}, footprint.radius(), 'R', [&](const Point& cell) { return inside(cell, footprint, 0.0); });
  const double reach = reach_of(footprint, clearance);
  // Finer than a cell nothing is drawn.
  routines::DistinctPoses drawn(0.5 * space.cell, 0.5 * space.cell / reach);
  for (const auto& pose : preview.path) drawn.add(pose);
  for (const auto& pose : std::move(drawn).take())
    map.fill({pose.x, pose.y}, reach, '.',
             [&, c = std::cos(pose.yaw), s = std::sin(pose.yaw)](const Point& cell) {
               const double dx = cell.x - pose.x, dy = cell.y - pose.y;
               return inside({c * dx + s * dy, c * dy - s * dx}, footprint, clearance);
             });
  for (const Point& point : points)
    if (!inside(point, footprint, 0.0)) map.mark(point, '#');
  space.rows = map.rows();
  const std::array<double, 4> needed = {box.front, box.left, -box.back, -box.right};
  for (std::size_t side = 0; side < needed.size(); ++side)
    space.sides.at(side) = {needed.at(side), nearest(points, footprint, clearance, side)};
  return space;
}

}  // namespace odomcalib::safety
