#include "calib/matching/probability_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

double log_odds_of(double probability) { return std::log(probability / (1.0 - probability)); }

}  // namespace

ProbabilityGrid::ProbabilityGrid(const GridOptions& options)
    : options_(options),
      hit_(log_odds_of(options.hit)),
      pass_(log_odds_of(options.pass)),
      limit_(log_odds_of(options.limit)),
      size_(2 * static_cast<int>(std::ceil(options.half_size / options.cell))),
      log_odds_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_), 0.0F) {}

void ProbabilityGrid::insert(const math::Pose& sensor, std::span<const Eigen::Vector2d> beam_ends) {
  const math::Frame frame(sensor);
  const Eigen::Vector2i from = cell_of(frame.origin());
  for (const Eigen::Vector2d& p : beam_ends) {
    const Eigen::Vector2i to = cell_of(frame.transform(p));
    trace(from, to);
    update(to, hit_);
  }
}

/// Bresenham's line, without its last cell.
void ProbabilityGrid::trace(const Eigen::Vector2i& from, const Eigen::Vector2i& to) {
  const Eigen::Vector2i span = (to - from).cwiseAbs();
  const Eigen::Vector2i sign(to.x() > from.x() ? 1 : -1, to.y() > from.y() ? 1 : -1);
  int error = span.x() - span.y();
  for (Eigen::Vector2i cell = from; cell != to && contains(cell);) {
    update(cell, pass_);
    const int twice = 2 * error;
    if (twice > -span.y()) {
      error -= span.y();
      cell.x() += sign.x();
    }
    if (twice < span.x()) {
      error += span.x();
      cell.y() += sign.y();
    }
  }
}

void ProbabilityGrid::update(const Eigen::Vector2i& cell, double log_odds) {
  if (!contains(cell)) return;
  float& value = log_odds_[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(size_) +
                           static_cast<std::size_t>(cell.x())];
  value = static_cast<float>(std::clamp(static_cast<double>(value) + log_odds, -limit_, limit_));
}

double ProbabilityGrid::probability(const Eigen::Vector2d& position) const {
  const Eigen::Vector2i cell = cell_of(position);
  if (!contains(cell)) return 0.5;
  const auto value =
      static_cast<double>(log_odds_[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(size_) +
                                    static_cast<std::size_t>(cell.x())]);
  return 1.0 / (1.0 + std::exp(-value));
}

bool ProbabilityGrid::contains(const Eigen::Vector2i& cell) const {
  return cell.minCoeff() >= 0 && cell.maxCoeff() < size_;
}

Eigen::Vector2i ProbabilityGrid::cell_of(const Eigen::Vector2d& position) const {
  constexpr double kFar = 1e6;  // outside of every map, and within int
  const double x = std::clamp(position.x() / options_.cell, -kFar, kFar);
  const double y = std::clamp(position.y() / options_.cell, -kFar, kFar);
  return {static_cast<int>(std::floor(x)) + size_ / 2, static_cast<int>(std::floor(y)) + size_ / 2};
}

}  // namespace odomcalib::calib::matching
