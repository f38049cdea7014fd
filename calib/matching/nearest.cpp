#include "calib/matching/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace odomcalib::calib::matching {
namespace {

constexpr double kTurn = 4.0;

/// Grows with the angle from the x axis, 0 to kTurn in a turn, and needs no arc tangent.
double pseudo_angle(const Eigen::Vector2d& p) {
  const double sum = std::abs(p.x()) + std::abs(p.y());
  if (!(sum > 0.0)) return 0.0;
  const double along = p.x() / sum;
  return p.y() < 0.0 ? 3.0 + along : 1.0 - along;
}

std::size_t share_of(double bearing, std::size_t shares) {
  return std::min(static_cast<std::size_t>(bearing / kTurn * static_cast<double>(shares)), shares - 1);
}

/// The best point so far and what bounds the search.
struct Best {
  const Eigen::Vector2d& position;
  double own;      ///< m^2, squared distance of the position from the sensor
  double squared;  ///< m^2, to the best point or the reach
  std::optional<std::size_t> entry;

  /// Whether no point on this ray, nor on any farther round on the same side, can be nearer.
  [[nodiscard]] bool is_beyond(const Eigen::Vector2d& direction) const {
    if (direction.dot(position) <= 0.0) return own > squared;
    const double across = direction.x() * position.y() - direction.y() * position.x();
    return across * across > squared;
  }
};

}  // namespace

Neighbour nearest_of_all(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& position) {
  Neighbour best{0, (points.front() - position).squaredNorm()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double squared = (points[i] - position).squaredNorm();
    if (squared < best.squared_distance) best = {i, squared};
  }
  return best;
}

struct NearestTree::Tree {
  std::vector<Eigen::Vector2d> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t point, std::size_t axis) const {
    return points[point](static_cast<Eigen::Index>(axis));
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
  using Index =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 2, std::size_t>;
  std::unique_ptr<Index> index;
};

NearestTree::NearestTree(std::vector<Eigen::Vector2d> points) : tree_(std::make_unique<Tree>()) {
  tree_->points = std::move(points);
  tree_->index = std::make_unique<Tree::Index>(2, *tree_, nanoflann::KDTreeSingleIndexAdaptorParams(8));
  if (!tree_->points.empty()) tree_->index->buildIndex();
}
NearestTree::~NearestTree() = default;
NearestTree::NearestTree(NearestTree&&) noexcept = default;
NearestTree& NearestTree::operator=(NearestTree&&) noexcept = default;

Neighbour NearestTree::nearest(const Eigen::Vector2d& position) const {
  Neighbour found;
  tree_->index->knnSearch(position.data(), 1, &found.index, &found.squared_distance);
  return found;
}

std::span<const Eigen::Vector2d> NearestTree::points() const { return tree_->points; }

BearingOrder::BearingOrder(std::span<const Eigen::Vector2d> points) {
  entries_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    entries_.push_back({points[i], points[i].normalized(), pseudo_angle(points[i]), i});
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.bearing < b.bearing; });
  const std::size_t shares = std::max<std::size_t>(entries_.size(), 1);
  places_.reserve(shares + 1);
  for (std::size_t i = 0; i < entries_.size(); ++i)
    while (places_.size() <= share_of(entries_[i].bearing, shares))
      places_.push_back(static_cast<std::uint32_t>(i));
  places_.resize(shares + 1, static_cast<std::uint32_t>(entries_.size()));
}

/// Place of the first entry that lies no nearer to the x axis.
std::size_t BearingOrder::place_of(double bearing) const {
  std::size_t place = places_[share_of(bearing, places_.size() - 1)];
  while (place < entries_.size() && entries_[place].bearing < bearing) ++place;
  return place;
}

std::optional<Neighbour> BearingOrder::nearest(const Eigen::Vector2d& position, double reach) const {
  const std::size_t n = entries_.size();
  Best best{position, position.squaredNorm(), reach * reach, std::nullopt};
  const std::size_t start = place_of(pseudo_angle(position));
  const auto look = [&](std::size_t place) {
    const Entry& entry = entries_[place];
    if (best.is_beyond(entry.direction)) return false;
    const double squared = (entry.position - position).squaredNorm();
    if (squared <= best.squared) best.squared = squared, best.entry = place;
    return true;
  };
  std::size_t place = start;
  for (std::size_t k = 0; k < n; ++k, ++place) {
    if (place >= n) place = 0;
    if (!look(place)) break;
  }
  place = start;
  for (std::size_t k = 0; k < n; ++k) {
    place = (place == 0 ? n : place) - 1;
    if (!look(place)) break;
  }
  if (!best.entry) return std::nullopt;
  return Neighbour{entries_[*best.entry].index, best.squared};
}

}  // namespace odomcalib::calib::matching
