// A map of cells that are probably free, occupied or unknown. H. Moravec and A. Elfes, ICRA 1985; the
// log-odds form as in S. Thrun, W. Burgard, D. Fox: Probabilistic Robotics, MIT Press 2005, table 9.1.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::matching {

struct GridOptions {
  double cell;                        ///< m
  double half_size;                   ///< m, the map is a square about the origin
  double hit = settings::kGridHit;    ///< probability of a cell to be occupied, given that a beam ended in it
  double pass = settings::kGridPass;  ///< the same, given that a beam passed it
  double limit = settings::kGridLimit;  ///< no cell becomes more certain, so that what moved can be unlearnt
};

class ProbabilityGrid {
 public:
  explicit ProbabilityGrid(const GridOptions& options);

  /// Cells between the sensor and the beam's end become freer, the one at its end more occupied. Beams that
  /// leave the map count as far as its border.
  void insert(const math::Pose& sensor, std::span<const Eigen::Vector2d> beam_ends);

  /// Probability that the cell at a position is occupied; 0.5 where nothing is known, and outside of the map.
  [[nodiscard]] double probability(const Eigen::Vector2d& position) const;

 private:
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& position) const;
  [[nodiscard]] bool contains(const Eigen::Vector2i& cell) const;
  void update(const Eigen::Vector2i& cell, double log_odds);
  void trace(const Eigen::Vector2i& from, const Eigen::Vector2i& to);

  GridOptions options_;
  double hit_, pass_, limit_;  ///< log-odds
  int size_;                   ///< cells on a side
  std::vector<float> log_odds_;
};

}  // namespace odomcalib::calib::matching
