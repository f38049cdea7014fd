// Nearest neighbours among the points of one scan, which lie about the sensor in the order of their bearing:
// the search goes on to either side until the ray alone is farther away than the best point, and is done
// after a few points where a tree has to be climbed. Exact, as nearest.hpp is.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/matching/nearest.hpp"

namespace odomcalib::calib::matching {

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
