#include "calib/matching/likelihood_field.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {
namespace {

Eigen::Vector2d lower_corner(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) corner = corner.cwiseMin(p);
  return corner.cwiseMax(-settings::kLargestMap_m);
}

Eigen::Vector2d upper_corner(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) corner = corner.cwiseMax(p);
  return corner.cwiseMin(settings::kLargestMap_m);
}

std::uint8_t larger(std::uint8_t a, std::uint8_t b) { return a > b ? a : b; }

/// Scores of the cells about a point.
struct Stamped {
  int dx, dy;
  std::uint8_t score;
};
using Stamp = std::vector<Stamped>;

Stamp make_stamp(const FieldOptions& options) {
  const int reach = static_cast<int>(options.cap / options.cell);
  Stamp stamp;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const double share = options.cell * std::hypot(dx, dy) / options.cap;
      if (share >= 1.0) continue;
      stamp.push_back(
          {dx, dy, static_cast<std::uint8_t>(std::lround(LikelihoodField::kBest * (1.0 - share)))});
    }
  return stamp;
}

}  // namespace

LikelihoodField::LikelihoodField(std::span<const Eigen::Vector2d> reference, const FieldOptions& options)
    : options_(options), pad_((1 << kMaxLevel) - 1) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(options.cap + options.cell);
  origin_ = lower_corner(reference) - margin;
  const Eigen::Vector2i last = cell_of(upper_corner(reference) + margin);
  width_ = last.x() + 1 + 2 * pad_;
  height_ = last.y() + 1 + 2 * pad_;
  scores_ = std::make_unique_for_overwrite<std::uint8_t[]>((kMaxLevel + 1) * cells());
  std::fill_n(scores_.get(), cells(), std::uint8_t{0});
  stamp(reference);
}

/// Scores around the points of the reference; where several points reach, the nearest counts.
void LikelihoodField::stamp(std::span<const Eigen::Vector2d> reference) {
  const Stamp stamp = make_stamp(options_);
  const CellBox map = within(0);
  for (const Eigen::Vector2d& point : reference) {
    if (!(point.cwiseAbs().maxCoeff() < settings::kLargestMap_m)) continue;
    const Eigen::Vector2i at = cell_of(point);
    for (const auto& [dx, dy, score] : stamp) {
      if (!map.has(at.x() + dx, at.y() + dy)) continue;
      std::uint8_t& cell = scores_[static_cast<std::size_t>(offset(at.x() + dx, at.y() + dy))];
      cell = larger(cell, score);
    }
  }
}

void LikelihoodField::add_levels(int highest) {
  for (; levels_ <= std::min(highest, kMaxLevel); ++levels_) make_coarser(levels_);
}

/// Maximum of four cells half a window apart. A row's end may see the beginning of the next, which only
/// raises a bound. Rows from which no window reaches the map are zero.
void LikelihoodField::make_coarser(int level) {
  const auto along = std::size_t{1} << (level - 1), across = along * static_cast<std::size_t>(width_);
  const std::uint8_t* const fine = scores(level - 1);
  std::uint8_t* const coarse = scores_.get() + static_cast<std::size_t>(level) * cells();
  const auto begin = static_cast<std::size_t>(offset(-pad_, 1 - (1 << level))),
             end = static_cast<std::size_t>(offset(-pad_, height_ - 2 * pad_));
  std::fill_n(coarse, begin, std::uint8_t{0});
  for (std::size_t i = begin; i < end; ++i)
    coarse[i] = larger(larger(fine[i], fine[i + along]), larger(fine[i + across], fine[i + across + along]));
  std::fill(coarse + end, coarse + cells(), std::uint8_t{0});
}

Eigen::Vector2i LikelihoodField::cell_of(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d cells = in_cells(position);
  constexpr double kFar = 1e6;  // outside of every map, and within int
  return {static_cast<int>(std::floor(std::clamp(cells.x(), -kFar, kFar))),
          static_cast<int>(std::floor(std::clamp(cells.y(), -kFar, kFar)))};
}

double LikelihoodField::fit(std::span<const Eigen::Vector2d> points, const math::Pose& pose) const {
  if (points.empty()) return 0.0;
  const math::Frame frame(pose);
  int sum = 0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2i at = cell_of(frame.transform(p));
    sum += score(0, at.x(), at.y());
  }
  return sum / (static_cast<double>(kBest) * static_cast<double>(points.size()));
}

}  // namespace odomcalib::calib::matching
