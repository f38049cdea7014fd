// How well a scan fits over a reference, without correspondences: every cell near the reference's points
// holds a score that falls with the distance to the nearest of them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "calib/matching/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::matching {

struct FieldOptions {
  double cell = settings::kFieldCell_m;  ///< m
  /// m; a point farther than this from the reference scores nothing, however far it is.
  double cap = settings::kFieldCap_m;
};

/// A rectangle of cells.
struct CellBox {
  int x = 0, y = 0;  ///< the first of them
  unsigned width = 0, height = 0;
  [[nodiscard]] bool has(int at_x, int at_y) const {
    // Differences below 0 turn into large numbers.
    const bool in_x = static_cast<unsigned>(at_x - x) < width,
               in_y = static_cast<unsigned>(at_y - y) < height;
    return in_x & in_y;
  }
};

class LikelihoodField {
 public:
  static constexpr int kBest = 255;  ///< score of a point that lies on a point of the reference

  static constexpr int kMaxLevel = 5;  ///< maxima over 32 cells

  LikelihoodField(std::span<const Eigen::Vector2d> reference, const FieldOptions& options);

  /// Best score of the 2^level by 2^level cells that begin at (x, y); 0 outside of the map, so that a pose
  /// that moves the scan off the map gains nothing by it. Levels above 0 are made by `add_levels`.
  [[nodiscard]] int score(int level, int x, int y) const {
    if (!within(0).has(x, y)) return 0;
    return scores(level)[offset(x, y)];
  }
  /// Scores of a level, for sums over many cells: that of (x, y) is at `offset(x, y)`, and a step of one cell
  /// in x or y always adds the same to it.
  [[nodiscard]] const std::uint8_t* scores(int level) const {
    return scores_.get() + static_cast<std::size_t>(level) * cells();
  }
  [[nodiscard]] std::ptrdiff_t offset(int x, int y) const {
    return static_cast<std::ptrdiff_t>(y + pad_) * width_ + (x + pad_);
  }
  /// Cells from which every step up to `reach` stays in the map.
  [[nodiscard]] CellBox within(int reach) const {
    const int width = std::max(width_ - 2 * reach, 0), height = std::max(height_ - 2 * reach, 0);
    return {reach - pad_, reach - pad_, static_cast<unsigned>(width), static_cast<unsigned>(height)};
  }
  /// Cells from which some step up to `reach` leads to where something scores: the map's margins never do.
  [[nodiscard]] CellBox about(int reach) const { return within(pad_ - reach); }
  /// Coarser maps for branch and bound; each holds maxima over four times as many cells as the one before.
  void add_levels(int highest);

  /// A position in the reference frame in units of cells.
  [[nodiscard]] Eigen::Vector2d in_cells(const Eigen::Vector2d& position) const {
    return (position - origin_) / options_.cell;
  }
  /// Cell of a position in the reference frame.
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& position) const;
  [[nodiscard]] double cell() const { return options_.cell; }
  /// Mean score of the points moved by `pose`, 0 to 1.
  [[nodiscard]] double fit(std::span<const Eigen::Vector2d> points, const math::Pose& pose) const;

 private:
  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  void stamp(std::span<const Eigen::Vector2d> reference);
  void make_coarser(int level);

  FieldOptions options_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int pad_ = 0;  ///< cells before the first and after the last, so that scans may reach out and coarse cells
                 ///< begin there
  int width_ = 0, height_ = 0;
  /// Scores of all levels, in one block; those not made yet are not even filled, which would cost as much.
  std::unique_ptr<std::uint8_t[]> scores_;
  int levels_ = 1;  ///< made so far
};

}  // namespace odomcalib::calib::matching
