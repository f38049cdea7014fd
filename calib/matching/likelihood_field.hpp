// How well a scan fits over a reference, without correspondences: every cell near the reference's points
// holds a score that falls with the distance to the nearest of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "calib/geometry/se2.hpp"

namespace odomcalib::calib {

struct FieldOptions {
  double cell = 0.1;  ///< m
  double cap = 0.3;   ///< m; a point farther than this from the reference scores nothing, however far it is
};

class LikelihoodField {
 public:
  static constexpr int kBest = 255;  ///< score of a point that lies on a point of the reference

  LikelihoodField(std::span<const Eigen::Vector2d> reference, const FieldOptions& options);

  /// Best score of the 2^level by 2^level cells that begin at (x, y); 0 outside of the map, so that a pose
  /// that moves the scan off the map gains nothing by it. Levels above 0 are made by `add_levels`.
  [[nodiscard]] int score(int level, int x, int y) const {
    x += pad_;
    y += pad_;
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return 0;
    return levels_[static_cast<std::size_t>(
        level)][static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }
  /// Coarser maps for branch and bound; each holds maxima over four times as many cells as the one before.
  void add_levels(int highest);

  /// Cell of a position in the reference frame.
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& position) const;
  [[nodiscard]] double cell() const { return options_.cell; }
  /// Mean score of the points moved by `pose`, 0 to 1.
  [[nodiscard]] double fit(std::span<const Eigen::Vector2d> points, const Pose& pose) const;

 private:
  using Level = std::vector<std::uint8_t>;
  void stamp(const Eigen::Vector2i& at);
  [[nodiscard]] Level coarser(const Level& fine, int reach) const;

  FieldOptions options_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int pad_ = 0;  ///< cells before the first, so that coarse cells may begin outside
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace odomcalib::calib
