// Nearest neighbours in the plane: a kd-tree, and the exhaustive search that it must agree with.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace odomcalib::calib::matching {

struct Neighbour {
  std::size_t index = 0;
  double squared_distance = 0.0;  ///< m^2
};

/// By comparing with every point; `points` must not be empty. Of equally near points, the first.
Neighbour nearest_of_all(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& position);

/// Exact, in O(log n). Holds its own copy of the points.
class NearestTree {
 public:
  explicit NearestTree(std::vector<Eigen::Vector2d> points);
  ~NearestTree();
  NearestTree(NearestTree&&) noexcept;
  NearestTree& operator=(NearestTree&&) noexcept;

  /// There must be a point. Of equally near points, any.
  [[nodiscard]] Neighbour nearest(const Eigen::Vector2d& position) const;
  [[nodiscard]] std::span<const Eigen::Vector2d> points() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace odomcalib::calib::matching
