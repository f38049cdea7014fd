#include "calib/matching/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace odomcalib::calib::matching {
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
        cell_x_(count_),
        cell_y_(count_),
        offset_(count_),
        is_inside_(count_),
        offsets_(count_ * static_cast<std::size_t>(2 * turns_ + 1)),
        turned_(static_cast<std::size_t>(2 * turns_ + 1)) {
    x_.reserve(count_);
    y_.reserve(count_);
    for (const Eigen::Vector2d& p : points) {
      const Eigen::Vector2d cells = (p / field.cell()).cwiseMax(-kFarthest).cwiseMin(kFarthest);
      x_.push_back(static_cast<float>(cells.x()));
      y_.push_back(static_cast<float>(cells.y()));
      farthest_ = std::max(farthest_, cells.norm());
    }
  }

  [[nodiscard]] int shifts() const { return shifts_; }
  [[nodiscard]] int turns() const { return turns_; }
  /// Cells that no point moves beyond, in x or y, when the scan turns by so many steps.
  [[nodiscard]] int reach_of_turn(int turns) const {
    return static_cast<int>(std::ceil(farthest_ * turns * window_.angle_step + kRounding));
  }
  /// Has to come before sums at this yaw. `beyond`: cells that sums may reach beyond the window.
  void place(int turn, int beyond = 0) {
    if (std::exchange(turned_[row(turn)].is_placed, true)) return;
    turn_points(turn);
    choose_cells(turn, shifts_ + beyond);
  }
  [[nodiscard]] math::Pose pose(int turn, int x, int y) const {
    return {window_.centre.x + x * field_.cell(), window_.centre.y + y * field_.cell(),
            window_.centre.yaw + turn * window_.angle_step};
  }
  [[nodiscard]] int score(int turn, int x, int y) const {
    const Turned& turned = turned_[row(turn)];
    const std::uint8_t* scores = field_.scores(0) + (field_.offset(x, y) - field_.offset(0, 0));
    int sum = 0;
    for (const std::int32_t at : turned.inside) sum += scores[at];
    for (const Eigen::Vector2i& cell : turned.border) sum += field_.score(0, cell.x() + x, cell.y() + y);
    return sum;
  }
  /// No pose of the 2^level by 2^level shifts that begin at (x, y) scores more than the first number; exact
  /// at level 0. The others are for the sets that begin `step` farther in x, in y and in both: they share
  /// most of the work. A set that begins outside of the window is given the bound of one inside.
  /// All are -1 when none exceeds `enough`: that shows before all points are added up.
  [[nodiscard]] FourSums bounds(int level, int turn, int x, int y, int step, int enough) const {
    const Turned& turned = turned_[row(turn)];
    const int far_x = std::min(x + step, shifts_), far_y = std::min(y + step, shifts_);
    const std::uint8_t* scores = field_.scores(level) - field_.offset(0, 0);
    const std::uint8_t* a = scores + field_.offset(x, y);
    const std::uint8_t* b = scores + field_.offset(far_x, y);
    const std::uint8_t* c = scores + field_.offset(x, far_y);
    const std::uint8_t* d = scores + field_.offset(far_x, far_y);
    FourSums sums{};
    const std::size_t count = turned.inside.size();
    for (std::size_t i = 0; i < count;) {
      for (const std::size_t end = std::min(i + kLookedAt, count); i < end; ++i) {
        const std::int32_t at = turned.inside[i];
        sums[0] += a[at];
        sums[1] += b[at];
        sums[2] += c[at];
        sums[3] += d[at];
      }
      const int rest = static_cast<int>(count - i + turned.border.size()) * LikelihoodField::kBest;
      if (std::max({sums[0], sums[1], sums[2], sums[3]}) + rest <= enough) return {-1, -1, -1, -1};
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
  static constexpr std::size_t kLookedAt = 24;  ///< points between two looks at whether a sum can be enough
  static constexpr double kRounding =
      0.05;  ///< cells; single precision, as far from the origin as maps reach

  /// The points at one yaw: those that no shift brings out of the map, as offsets into it, and those that
  /// some shift does. What no shift brings to where something scores is left out.
  struct Turned {
    bool is_placed = false;
    std::span<const std::int32_t> inside;
    std::vector<Eigen::Vector2i> border;
  };

  [[nodiscard]] std::size_t row(int turn) const {
    return static_cast<std::size_t>(std::int64_t{turn} + turns_);
  }

  /// Cells of the points at one yaw; a shift in x and y then only adds to them. Plain loops over plain
  /// arrays of narrow numbers, which the compiler turns into vector instructions.
  void turn_points(int turn) {
    constexpr int kPositive = 1024;  // added so that truncation rounds down wherever there is a map
    const double yaw = window_.centre.yaw + turn * window_.angle_step;
    const auto c = static_cast<float>(std::cos(yaw)), s = static_cast<float>(std::sin(yaw));
    const Eigen::Vector2f at = field_.in_cells({window_.centre.x, window_.centre.y})
                                   .cwiseMax(-kFarthest)
                                   .cwiseMin(kFarthest)
                                   .cast<float>();
    const float x0 = at.x() + kPositive, y0 = at.y() + kPositive;
    const float* const x = x_.data();
    const float* const y = y_.data();
    int* const cell_x = cell_x_.data();
    int* const cell_y = cell_y_.data();
    const std::size_t count = count_;
    for (std::size_t i = 0; i < count; ++i)
      cell_x[i] = static_cast<int>(x0 + c * x[i] - s * y[i]) - kPositive;
    for (std::size_t i = 0; i < count; ++i)
      cell_y[i] = static_cast<int>(y0 + s * x[i] + c * y[i]) - kPositive;
  }

  /// Sorts the cells into those of `inside`, those of the border and the rest, without a branch for each:
  /// which point is where a processor guesses badly.
  void choose_cells(int turn, int reach) {
    const CellBox inside = field_.within(reach), scoring = field_.about(reach);
    // Without a sign, as products of cells that are in no map may not fit.
    const auto begin = static_cast<unsigned>(field_.offset(0, 0));
    const auto width = static_cast<unsigned>(field_.offset(0, 1)) - begin;
    const int* const cell_x = cell_x_.data();
    const int* const cell_y = cell_y_.data();
    int* const offset = offset_.data();
    int* const is_inside = is_inside_.data();
    const std::size_t count = count_;
    int border = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const int scores = scoring.has(cell_x[i], cell_y[i]), stays = inside.has(cell_x[i], cell_y[i]);
      offset[i] = static_cast<int>(begin + static_cast<unsigned>(cell_y[i]) * width +
                                   static_cast<unsigned>(cell_x[i]));
      is_inside[i] = scores & stays;
      border += scores & ~stays;
    }
    std::int32_t* const first = offsets_.data() + row(turn) * count;
    std::int32_t* next = first;
    for (std::size_t i = 0; i < count; ++i) {
      *next = offset[i];
      next += is_inside[i];
    }
    turned_[row(turn)].inside = {first, next};
    for (std::size_t i = 0; i < count && border > 0; ++i) {
      if (is_inside[i] != 0 || !scoring.has(cell_x[i], cell_y[i])) continue;
      turned_[row(turn)].border.emplace_back(cell_x[i], cell_y[i]);
      --border;
    }
  }

  const LikelihoodField& field_;
  SearchWindow window_;
  std::size_t count_;
  int shifts_, turns_;
  double farthest_ = 0.0;     ///< of the points from the scan's origin, in cells
  std::vector<float> x_, y_;  ///< of the points, in cells
  std::vector<int> cell_x_, cell_y_, offset_, is_inside_;
  std::vector<std::int32_t> offsets_;
  std::vector<Turned> turned_;
};

/// A set of poses that begins at (x, y), and a score that none of them exceeds.
struct Node {
  int level, turn, x, y, bound;
};

/// Straight down to one good pose first, which excludes most of the sets; then best first: when the most
/// promising set left is no better than the best pose, none is.
class BranchAndBound {
 public:
  BranchAndBound(Lattice& lattice, int highest) : lattice_(lattice), highest_(highest) {
    // The window's sets are wider than they need be; what is left over covers neighbouring turns.
    const int spare = (1 << highest) / 8;
    while (group_ < kMostTurns && lattice.reach_of_turn(group_ + 1) <= spare) ++group_;
    margin_ = group_ == 0 ? 0 : lattice.reach_of_turn(group_);
  }

  SearchResult run() {
    open_window();
    dive();
    std::erase_if(open_, [this](const Node& set) { return set.bound <= best_.bound; });
    std::make_heap(open_.begin(), open_.end(), less_promising);
    while (!open_.empty() && open_.front().bound > best_.bound) divide(take());
    return {lattice_.pose(best_.turn, best_.x, best_.y), lattice_.mean(best_.bound), evaluated_};
  }

 private:
  static constexpr int kMostTurns = 3;  ///< to each side that are looked at together

  /// The finer one of equals is taken first: it is nearer to the end.
  static bool less_promising(const Node& a, const Node& b) {
    return a.bound != b.bound ? a.bound < b.bound : a.level > b.level;
  }
  Node take() {
    std::pop_heap(open_.begin(), open_.end(), less_promising);
    const Node next = open_.back();
    open_.pop_back();
    return next;
  }
  /// From the best set to its best part, down to a single pose.
  void dive() {
    for (std::ptrdiff_t first = 0; first < std::ssize(open_);) {
      std::iter_swap(std::max_element(open_.begin() + first, open_.end(), less_promising), open_.end() - 1);
      const Node next = open_.back();
      open_.pop_back();
      first = std::ssize(open_);
      split(next);
    }
  }
  /// Sets of the highest level hold neighbouring turns, too.
  void open_window() {
    const int shifts = lattice_.shifts(), span = (1 << highest_) - 2 * margin_;
    for (int first = -lattice_.turns(); first <= lattice_.turns(); first += 2 * group_ + 1) {
      const int turn = std::min(first + group_, lattice_.turns());
      lattice_.place(turn, margin_);
      for (int y = -shifts; y <= shifts; y += 2 * span)
        for (int x = -shifts; x <= shifts; x += 2 * span) open_four(highest_, turn, x, y, span, margin_);
    }
  }
  void open_four(int level, int turn, int x, int y, int step, int margin) {
    const FourSums bounds = lattice_.bounds(level, turn, x - margin, y - margin, step, best_.bound);
    for (int k = 0; k < 4; ++k) {
      const int at_x = x + k % 2 * step, at_y = y + k / 2 * step;
      if (at_x > lattice_.shifts() || at_y > lattice_.shifts()) continue;
      ++evaluated_;
      keep({level, turn, at_x, at_y, bounds[static_cast<std::size_t>(k)]});
    }
  }
  void keep(const Node& set) {
    if (set.bound <= best_.bound) return;
    if (set.level == 0)
      best_ = set;
    else
      open_.push_back(set);
  }
  /// Appends the parts of a set that may hold something better than the best pose so far.
  void split(const Node& parent) {
    const int others = parent.level == highest_ ? group_ : 0, half = 1 << (parent.level - 1);
    const int first = std::max(parent.turn - others, -lattice_.turns()),
              last = std::min(parent.turn + others, lattice_.turns());
    for (int turn = first; turn <= last; ++turn) {
      lattice_.place(turn, margin_);
      open_four(parent.level - 1, turn, parent.x, parent.y, half, 0);
    }
  }
  void divide(const Node& parent) {
    const auto before = std::ssize(open_);
    split(parent);
    for (auto end = open_.begin() + before; end != open_.end();)
      std::push_heap(open_.begin(), ++end, less_promising);
  }

  Lattice& lattice_;
  int highest_;
  int group_ = 0;   ///< turns to each side that sets of the highest level hold, too
  int margin_ = 0;  ///< cells that points move by then
  std::vector<Node> open_;
  Node best_{0, 0, 0, 0, -1};
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
  Lattice lattice(field, points, window);
  SearchResult result;
  int best = -1;
  for (int turn = -lattice.turns(); turn <= lattice.turns(); ++turn) {
    lattice.place(turn);
    for (int y = -lattice.shifts(); y <= lattice.shifts(); ++y)
      for (int x = -lattice.shifts(); x <= lattice.shifts(); ++x) {
        const int sum = lattice.score(turn, x, y);
        ++result.evaluated;
        if (sum <= best) continue;
        best = sum;
        result.pose = lattice.pose(turn, x, y);
      }
  }
  result.score = lattice.mean(best);
  return result;
}

SearchResult search_branch_and_bound(LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                     const SearchWindow& window) {
  Lattice lattice(field, points, window);
  const int highest = highest_level(lattice.shifts());
  field.add_levels(highest);
  return BranchAndBound(lattice, highest).run();
}

SearchResult search_hill_climb(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                               const math::Pose& start, const ClimbOptions& options) {
  SearchResult best{start, field.fit(points, start), 1};
  double step = options.step;
  double turn = options.angle_step;
  for (int halving = 0; halving <= options.halvings;) {
    const math::Pose at = best.pose;
    const std::array<math::Pose, 6> neighbours{{{at.x + step, at.y, at.yaw},
                                                {at.x - step, at.y, at.yaw},
                                                {at.x, at.y + step, at.yaw},
                                                {at.x, at.y - step, at.yaw},
                                                {at.x, at.y, at.yaw + turn},
                                                {at.x, at.y, at.yaw - turn}}};
    bool better = false;
    for (const math::Pose& pose : neighbours) {
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

}  // namespace odomcalib::calib::matching
