#include "calib/matching/likelihood_field.hpp"

#include <algorithm>
#include <cmath>

#include "calib/geometry/vector2.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kMaxExtent = 200.0;  ///< m; what lies farther out is left out of the map

Eigen::Vector2d lower_corner(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) corner = corner.cwiseMin(p);
  return corner.cwiseMax(-kMaxExtent);
}

Eigen::Vector2d upper_corner(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) corner = corner.cwiseMax(p);
  return corner.cwiseMin(kMaxExtent);
}

std::uint8_t larger(std::uint8_t a, std::uint8_t b) { return a > b ? a : b; }

}  // namespace

LikelihoodField::LikelihoodField(std::span<const Eigen::Vector2d> reference, const FieldOptions& options)
    : options_(options), pad_((1 << kMaxLevel) - 1) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(options.cap + options.cell);
  origin_ = lower_corner(reference) - margin;
  const Eigen::Vector2i last = cell_of(upper_corner(reference) + margin);
  width_ = last.x() + 1 + 2 * pad_;
  height_ = last.y() + 1 + 2 * pad_;
  scores_.reserve((kMaxLevel + 1) * cells());
  scores_.resize(cells());
  for (const Eigen::Vector2d& point : reference)
    if (point.cwiseAbs().maxCoeff() < kMaxExtent) stamp(cell_of(point));
}

/// Scores around one point of the reference; where several points reach, the nearest counts.
void LikelihoodField::stamp(const Eigen::Vector2i& at) {
  const int reach = static_cast<int>(options_.cap / options_.cell);
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const double distance = options_.cell * std::hypot(dx, dy);
      const int x = at.x() + dx + pad_;
      const int y = at.y() + dy + pad_;
      if (distance >= options_.cap || x < 0 || y < 0 || x >= width_ || y >= height_) continue;
      auto& cell = scores_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x)];
      cell = std::max(cell, static_cast<std::uint8_t>(std::lround(kBest * (1.0 - distance / options_.cap))));
    }
}

void LikelihoodField::add_levels(int highest) {
  for (int level = static_cast<int>(scores_.size() / cells()); level <= std::min(highest, kMaxLevel); ++level)
    make_coarser(level);
}

/// Maximum of four cells half a window apart. First along rows, then of rows; a row's end may see the
/// beginning of the next, which only raises a bound.
void LikelihoodField::make_coarser(int level) {
  scores_.resize(static_cast<std::size_t>(level + 1) * cells());
  const auto along = std::ptrdiff_t{1} << (level - 1);
  const auto across = along * width_;
  const auto coarse = scores_.end() - static_cast<std::ptrdiff_t>(cells());
  const auto fine = coarse - static_cast<std::ptrdiff_t>(cells());
  std::transform(fine, coarse - along, fine + along, coarse, larger);
  std::copy(coarse - along, coarse, scores_.end() - along);
  std::transform(coarse, scores_.end() - across, coarse + across, coarse, larger);
}

Eigen::Vector2i LikelihoodField::cell_of(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d cells = in_cells(position);
  constexpr double kFar = 1e6;  // outside of every map, and within int
  return {static_cast<int>(std::floor(std::clamp(cells.x(), -kFar, kFar))),
          static_cast<int>(std::floor(std::clamp(cells.y(), -kFar, kFar)))};
}

double LikelihoodField::fit(std::span<const Eigen::Vector2d> points, const Pose& pose) const {
  if (points.empty()) return 0.0;
  const Frame frame(pose);
  int sum = 0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2i at = cell_of(frame.transform(p));
    sum += score(0, at.x(), at.y());
  }
  return sum / (static_cast<double>(kBest) * static_cast<double>(points.size()));
}

}  // namespace odomcalib::calib
