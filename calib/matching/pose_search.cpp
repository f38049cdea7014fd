#include "calib/matching/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace odomcalib::calib {
namespace {

/// Lattice steps on each side of the centre.
int steps(double half, double step) { return static_cast<int>(std::floor(half / step + 1e-9)); }

/// Cells from the origin of the field; what lies farther out is in no map and counts as a point that does not
/// fit.
constexpr double kFarthest = 1e5;

using FourSums = std::array<int, 4>;

/// The lattice of a window, and the sums of scores on it: whole numbers, so that equal means equal.
class Lattice {
 public:
  Lattice(const LikelihoodField& field, std::span<const Eigen::Vector2d> points, const SearchWindow& window)
      : field_(field),
        window_(window),
        count_(points.size()),
        shifts_(steps(window.half_width, field.cell())),
        turns_(steps(window.half_angle, window.angle_step)),
        offsets_(count_ * static_cast<std::size_t>(2 * turns_ + 1)),
        turned_(static_cast<std::size_t>(2 * turns_ + 1)) {
    for (const Eigen::Vector2d& p : points) {
      if (!(p.norm() < kFarthest * field.cell())) continue;
      x_.push_back(p.x() / field.cell());
      y_.push_back(p.y() / field.cell());
    }
    cell_x_.resize(x_.size());
    cell_y_.resize(x_.size());
    for (int turn = -turns_; turn <= turns_; ++turn) place(turn);
  }

  [[nodiscard]] int shifts() const { return shifts_; }
  [[nodiscard]] int turns() const { return turns_; }
  [[nodiscard]] Pose pose(int turn, int x, int y) const {
    return {window_.centre.x + x * field_.cell(), window_.centre.y + y * field_.cell(),
            window_.centre.yaw + turn * window_.angle_step};
  }
  [[nodiscard]] int score(int turn, int x, int y) const {
    const Turned& turned = turned_[static_cast<std::size_t>(turn + turns_)];
    const std::uint8_t* scores = field_.scores(0) + (field_.offset(x, y) - field_.offset(0, 0));
    int sum = 0;
    for (const std::int32_t at : turned.inside) sum += scores[at];
    for (const Eigen::Vector2i& cell : turned.border) sum += field_.score(0, cell.x() + x, cell.y() + y);
    return sum;
  }
  /// No pose of the 2^level by 2^level shifts that begin at (x, y) scores more than the first number; exact
  /// at level 0. The others are for the sets that begin 2^level farther in x, in y and in both: they share
  /// most of the work. A set that begins outside of the window is given the bound of one inside.
  [[nodiscard]] FourSums bounds(int level, int turn, int x, int y) const {
    const Turned& turned = turned_[static_cast<std::size_t>(turn + turns_)];
    const int far_x = std::min(x + (1 << level), shifts_), far_y = std::min(y + (1 << level), shifts_);
    const std::uint8_t* scores = field_.scores(level) - field_.offset(0, 0);
    const std::uint8_t* a = scores + field_.offset(x, y);
    const std::uint8_t* b = scores + field_.offset(far_x, y);
    const std::uint8_t* c = scores + field_.offset(x, far_y);
    const std::uint8_t* d = scores + field_.offset(far_x, far_y);
    FourSums sums{};
    for (const std::int32_t at : turned.inside) {
      sums[0] += a[at];
      sums[1] += b[at];
      sums[2] += c[at];
      sums[3] += d[at];
    }
    for (const Eigen::Vector2i& cell : turned.border) {
      sums[0] += field_.score(level, cell.x() + x, cell.y() + y);
      sums[1] += field_.score(level, cell.x() + far_x, cell.y() + y);
      sums[2] += field_.score(level, cell.x() + x, cell.y() + far_y);
      sums[3] += field_.score(level, cell.x() + far_x, cell.y() + far_y);
    }
    return sums;
  }
  [[nodiscard]] double mean(int sum) const {
    return count_ == 0 ? 0.0
                       : sum / (static_cast<double>(LikelihoodField::kBest) * static_cast<double>(count_));
  }

 private:
  /// The points at one yaw: those that no shift brings out of the map, as offsets into it, and those that
  /// some shift does. What no shift brings to where something scores is left out.
  struct Turned {
    std::span<const std::int32_t> inside;
    std::vector<Eigen::Vector2i> border;
  };

  /// Cells of the points at one yaw; a shift in x and y then only adds to them. Plain loops over plain
  /// arrays, which the compiler turns into vector instructions.
  void turn_points(int turn) {
    constexpr double kPositive = 3.0 * kFarthest;  // added so that truncation rounds down
    const double yaw = window_.centre.yaw + turn * window_.angle_step;
    const double c = std::cos(yaw), s = std::sin(yaw);
    const Eigen::Vector2d at =
        field_.in_cells({window_.centre.x, window_.centre.y}).cwiseMax(-kFarthest).cwiseMin(kFarthest);
    const double x0 = at.x() + kPositive, y0 = at.y() + kPositive;
    const double* const x = x_.data();
    const double* const y = y_.data();
    int* const cell_x = cell_x_.data();
    int* const cell_y = cell_y_.data();
    const std::size_t count = x_.size();
    for (std::size_t i = 0; i < count; ++i)
      cell_x[i] = static_cast<int>(x0 + c * x[i] - s * y[i]) - static_cast<int>(kPositive);
    for (std::size_t i = 0; i < count; ++i)
      cell_y[i] = static_cast<int>(y0 + s * x[i] + c * y[i]) - static_cast<int>(kPositive);
  }

  void place(int turn) {
    turn_points(turn);
    const auto row = static_cast<std::size_t>(turn + turns_);
    std::int32_t* const first = offsets_.data() + row * count_;
    std::int32_t* next = first;
    const CellBox inside = field_.within(shifts_), scoring = field_.about(shifts_);
    const std::ptrdiff_t begin = field_.offset(0, 0), width = field_.offset(0, 1) - begin;
    const int* const cell_x = cell_x_.data();
    const int* const cell_y = cell_y_.data();
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const int x = cell_x[i], y = cell_y[i];
      if (!scoring.has(x, y)) continue;
      if (inside.has(x, y))
        *next++ = static_cast<std::int32_t>(begin + y * width + x);
      else
        turned_[row].border.emplace_back(x, y);
    }
    turned_[row].inside = {first, next};
  }

  const LikelihoodField& field_;
  SearchWindow window_;
  std::size_t count_;
  int shifts_, turns_;
  std::vector<double> x_, y_;  ///< of the points, in cells
  std::vector<int> cell_x_, cell_y_;
  std::vector<std::int32_t> offsets_;
  std::vector<Turned> turned_;
};

struct Node {
  int level, turn, x, y, bound;
};

/// Best first: when the most promising set left is a single pose, none can be better.
class BranchAndBound {
 public:
  explicit BranchAndBound(const Lattice& lattice) : lattice_(lattice) {}

  SearchResult run(int highest) {
    const int shifts = lattice_.shifts();
    open_.reserve(static_cast<std::size_t>(16 * (2 * lattice_.turns() + 1)));
    for (int turn = -lattice_.turns(); turn <= lattice_.turns(); ++turn)
      for (int y = -shifts; y <= shifts; y += 2 << highest)
        for (int x = -shifts; x <= shifts; x += 2 << highest) open_four(highest, turn, x, y);
    std::make_heap(open_.begin(), open_.end(), less_promising);
    while (open_.front().level > 0) quarter(take());
    const Node& best = open_.front();
    return {lattice_.pose(best.turn, best.x, best.y), lattice_.mean(best.bound), evaluated_};
  }

 private:
  /// Of equals the finer one is taken first: it is nearer to the end.
  static bool less_promising(const Node& a, const Node& b) {
    return a.bound != b.bound ? a.bound < b.bound : a.level > b.level;
  }
  Node take() {
    std::pop_heap(open_.begin(), open_.end(), less_promising);
    const Node next = open_.back();
    open_.pop_back();
    return next;
  }
  void open_four(int level, int turn, int x, int y) {
    const FourSums bounds = lattice_.bounds(level, turn, x, y);
    for (int k = 0; k < 4; ++k) {
      const int at_x = x + (k % 2 << level), at_y = y + (k / 2 << level);
      if (at_x > lattice_.shifts() || at_y > lattice_.shifts()) continue;
      open_.push_back({level, turn, at_x, at_y, bounds[static_cast<std::size_t>(k)]});
      ++evaluated_;
    }
  }
  void quarter(const Node& parent) {
    const auto before = static_cast<std::ptrdiff_t>(open_.size());
    open_four(parent.level - 1, parent.turn, parent.x, parent.y);
    for (auto end = open_.begin() + before; end != open_.end();)
      std::push_heap(open_.begin(), ++end, less_promising);
  }

  const Lattice& lattice_;
  std::vector<Node> open_;
  std::size_t evaluated_ = 0;
};

/// Two sets a side cover the window: coarser ones would hardly exclude anything.
int highest_level(int shifts) {
  int level = 0;
  while ((2 << level) < 2 * shifts + 1 && level < LikelihoodField::kMaxLevel) ++level;
  return level;
}

}  // namespace

std::vector<Eigen::Vector2d> thinned(std::span<const Eigen::Vector2d> points, std::size_t most) {
  const std::size_t stride = points.size() / most + 1;
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t i = 0; i < points.size(); i += stride) kept.push_back(points[i]);
  return kept;
}

SearchResult search_brute_force(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                const SearchWindow& window) {
  const Lattice lattice(field, points, window);
  SearchResult result;
  int best = -1;
  for (int turn = -lattice.turns(); turn <= lattice.turns(); ++turn)
    for (int y = -lattice.shifts(); y <= lattice.shifts(); ++y)
      for (int x = -lattice.shifts(); x <= lattice.shifts(); ++x) {
        const int sum = lattice.score(turn, x, y);
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
