#include "calib/matching/nearest.hpp"

#include <nanoflann.hpp>

namespace odomcalib::calib::matching {

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

}  // namespace odomcalib::calib::matching
