#include "calib/matching/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace odomcalib::calib {
namespace {

/// Lattice steps on each side of the centre.
int steps(double half, double step) { return static_cast<int>(std::floor(half / step + 1e-9)); }

/// Cells of the points at one yaw; a shift in x and y then only adds to them.
std::vector<Eigen::Vector2i> cells_at(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                      const Pose& pose) {
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  std::vector<Eigen::Vector2i> cells;
  cells.reserve(points.size());
  for (const Eigen::Vector2d& p : points)
    cells.push_back(field.cell_of({pose.x + c * p.x() - s * p.y(), pose.y + s * p.x() + c * p.y()}));
  return cells;
}

/// The lattice of a window, and the sums of scores on it: whole numbers, so that equal means equal.
class Lattice {
 public:
  Lattice(const LikelihoodField& field, std::span<const Eigen::Vector2d> points, const SearchWindow& window)
      : field_(field),
        window_(window),
        count_(points.size()),
        shifts_(steps(window.half_width, field.cell())),
        turns_(steps(window.half_angle, window.angle_step)) {
    for (int turn = -turns_; turn <= turns_; ++turn)
      cells_.push_back(cells_at(field, points, pose(turn, 0, 0)));
  }

  [[nodiscard]] int shifts() const { return shifts_; }
  [[nodiscard]] int turns() const { return turns_; }
  [[nodiscard]] Pose pose(int turn, int x, int y) const {
    return {window_.centre.x + x * field_.cell(), window_.centre.y + y * field_.cell(),
            window_.centre.yaw + turn * window_.angle_step};
  }
  /// No pose of the 2^level by 2^level shifts that begin at (x, y) scores more; exact at level 0.
  [[nodiscard]] int bound(int level, int turn, int x, int y) const {
    int sum = 0;
    for (const Eigen::Vector2i& cell : cells_[static_cast<std::size_t>(turn + turns_)])
      sum += field_.score(level, cell.x() + x, cell.y() + y);
    return sum;
  }
  [[nodiscard]] double mean(int sum) const {
    return count_ == 0 ? 0.0
                       : sum / (static_cast<double>(LikelihoodField::kBest) * static_cast<double>(count_));
  }

 private:
  const LikelihoodField& field_;
  SearchWindow window_;
  std::size_t count_;
  int shifts_, turns_;
  std::vector<std::vector<Eigen::Vector2i>> cells_;
};

struct Node {
  int level, turn, x, y, bound;
};

class BranchAndBound {
 public:
  explicit BranchAndBound(const Lattice& lattice) : lattice_(lattice) {}

  SearchResult run(int highest) {
    std::vector<Node> roots;
    const int shifts = lattice_.shifts();
    for (int turn = -lattice_.turns(); turn <= lattice_.turns(); ++turn)
      for (int y = -shifts; y <= shifts; y += 1 << highest)
        for (int x = -shifts; x <= shifts; x += 1 << highest) roots.push_back(node(highest, turn, x, y));
    explore(roots);
    return {lattice_.pose(best_.turn, best_.x, best_.y), lattice_.mean(best_.bound), evaluated_};
  }

 private:
  Node node(int level, int turn, int x, int y) {
    ++evaluated_;
    return {level, turn, x, y, lattice_.bound(level, turn, x, y)};
  }

  /// The most promising first, so that the others fall below the best found.
  void explore(std::vector<Node>& nodes) {
    std::sort(nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.bound > b.bound; });
    for (const Node& next : nodes) {
      if (next.bound <= best_.bound) return;
      if (next.level == 0) {
        best_ = next;
        continue;
      }
      std::vector<Node> children = quarter(next);
      explore(children);  // as deep as there are levels
    }
  }

  std::vector<Node> quarter(const Node& parent) {
    std::vector<Node> children;
    const int half = 1 << (parent.level - 1);
    for (const int dy : {0, half})
      for (const int dx : {0, half})
        if (parent.x + dx <= lattice_.shifts() && parent.y + dy <= lattice_.shifts())
          children.push_back(node(parent.level - 1, parent.turn, parent.x + dx, parent.y + dy));
    return children;
  }

  const Lattice& lattice_;
  Node best_{0, 0, 0, 0, -1};
  std::size_t evaluated_ = 0;
};

int highest_level(int shifts) {
  int level = 0;
  while ((1 << (level + 1)) <= shifts && level < 5) ++level;
  return level;
}

}  // namespace

SearchResult search_brute_force(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                const SearchWindow& window) {
  const Lattice lattice(field, points, window);
  SearchResult result;
  int best = -1;
  for (int turn = -lattice.turns(); turn <= lattice.turns(); ++turn)
    for (int y = -lattice.shifts(); y <= lattice.shifts(); ++y)
      for (int x = -lattice.shifts(); x <= lattice.shifts(); ++x) {
        const int sum = lattice.bound(0, turn, x, y);
        ++result.evaluated;
        if (sum <= best) continue;
        best = sum;
        result.pose = lattice.pose(turn, x, y);
      }
  result.score = lattice.mean(best);
  return result;
}

SearchResult search_branch_and_bound(LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                     const SearchWindow& window) {
  const Lattice lattice(field, points, window);
  const int highest = highest_level(lattice.shifts());
  field.add_levels(highest);
  return BranchAndBound(lattice).run(highest);
}

SearchResult search_hill_climb(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                               const Pose& start, const ClimbOptions& options) {
  SearchResult best{start, field.fit(points, start), 1};
  double step = options.step;
  double turn = options.angle_step;
  for (int halving = 0; halving <= options.halvings;) {
    const Pose at = best.pose;
    const std::array<Pose, 6> neighbours{{{at.x + step, at.y, at.yaw},
                                          {at.x - step, at.y, at.yaw},
                                          {at.x, at.y + step, at.yaw},
                                          {at.x, at.y - step, at.yaw},
                                          {at.x, at.y, at.yaw + turn},
                                          {at.x, at.y, at.yaw - turn}}};
    bool better = false;
    for (const Pose& pose : neighbours) {
      const double score = field.fit(points, pose);
      ++best.evaluated;
      if (score <= best.score) continue;
      best.score = score;
      best.pose = pose;
      better = true;
    }
    if (better) continue;
    ++halving;
    step /= 2.0;
    turn /= 2.0;
  }
  return best;
}

}  // namespace odomcalib::calib
