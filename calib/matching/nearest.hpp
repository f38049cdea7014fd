// Nearest neighbours in the plane: a kd-tree, and the exhaustive search that it must agree with.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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

/// Nearest neighbours among the points of one scan, which lie about the sensor in the order of their bearing:
/// the search goes on to either side until the ray alone is farther away than the best point, and is done
/// after a few points where a tree has to be climbed. Exact, as the tree is.
class BearingOrder {
 public:
  /// @param points m, about the origin; in any order
  explicit BearingOrder(std::span<const Eigen::Vector2d> points);

  /// The nearest point no farther away than `reach`, m; none where there is none. Of equally near points,
  /// any.
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector2d& position, double reach) const;

 private:
  struct Entry {
    Eigen::Vector2d position;
    Eigen::Vector2d direction;  ///< of length 1
    double bearing = 0.0;       ///< as given by `pseudo_angle`
    std::size_t index = 0;      ///< among the points given
  };
  [[nodiscard]] std::size_t place_of(double bearing) const;

  std::vector<Entry> entries_;         ///< by bearing
  std::vector<std::uint32_t> places_;  ///< of the first entry of each of equal shares of a turn, and the end
};

}  // namespace odomcalib::calib::matching
