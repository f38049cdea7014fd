#include "calib/matching/likelihood_field.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::calib {
namespace {

constexpr int kMaxLevel = 6;          ///< maxima over 64 cells
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

}  // namespace

LikelihoodField::LikelihoodField(std::span<const Eigen::Vector2d> reference, const FieldOptions& options)
    : options_(options), pad_((1 << kMaxLevel) - 1) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(options.cap + options.cell);
  origin_ = lower_corner(reference) - margin;
  const Eigen::Vector2i last = cell_of(upper_corner(reference) + margin);
  width_ = last.x() + 1 + pad_;
  height_ = last.y() + 1 + pad_;
  levels_.emplace_back(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
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
      auto& cell = levels_.front()[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(x)];
      cell = std::max(cell, static_cast<std::uint8_t>(std::lround(kBest * (1.0 - distance / options_.cap))));
    }
}

void LikelihoodField::add_levels(int highest) {
  while (static_cast<int>(levels_.size()) <= std::min(highest, kMaxLevel))
    levels_.push_back(coarser(levels_.back(), 1 << (levels_.size() - 1)));
}

/// Maximum of four cells `reach` apart: twice as wide a window.
LikelihoodField::Level LikelihoodField::coarser(const Level& fine, int reach) const {
  Level coarse = fine;
  const auto width = static_cast<std::size_t>(width_);
  const auto step = static_cast<std::size_t>(reach);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y)
    for (std::size_t x = 0; x + step < width; ++x)
      coarse[y * width + x] = std::max(fine[y * width + x], fine[y * width + x + step]);
  for (std::size_t y = 0; y + step < static_cast<std::size_t>(height_); ++y)
    for (std::size_t x = 0; x < width; ++x)
      coarse[y * width + x] = std::max(coarse[y * width + x], coarse[(y + step) * width + x]);
  return coarse;
}

Eigen::Vector2i LikelihoodField::cell_of(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d cells = (position - origin_) / options_.cell;
  constexpr double kFar = 1e6;  // outside of every map, and within int
  return {static_cast<int>(std::floor(std::clamp(cells.x(), -kFar, kFar))),
          static_cast<int>(std::floor(std::clamp(cells.y(), -kFar, kFar)))};
}

double LikelihoodField::fit(std::span<const Eigen::Vector2d> points, const Pose& pose) const {
  if (points.empty()) return 0.0;
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  int sum = 0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2i at = cell_of({pose.x + c * p.x() - s * p.y(), pose.y + s * p.x() + c * p.y()});
    sum += score(0, at.x(), at.y());
  }
  return sum / (static_cast<double>(kBest) * static_cast<double>(points.size()));
}

}  // namespace odomcalib::calib
