#include "calib/measurement/sector_index.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/measurement/wall_map.hpp"

namespace odomcalib::calib::measurement {
namespace {

constexpr double kRounding = 1e-9;  // rad

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance_to_segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double share = std::clamp(-a.dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
  return (a + share * way).norm();
}

}  // namespace

// Grows with the angle like it, without an arc tangent: 1 in each quadrant, 0 along -x.
std::size_t SectorIndex::sector_of(const Eigen::Vector2d& direction) {
  const double x = direction.x(), y = direction.y();
  const double slope = x / (std::abs(x) + std::abs(y));
  const double turned = y < 0.0 ? 1.0 + slope : 3.0 - slope;
  return static_cast<std::size_t>(turned * (0.25 * kSectors)) % kSectors;
}

// From any origin within `reach` a point of the wall lies no farther aside than asin(reach / distance) from
// where the eye sees it.
SectorIndex::Sweep SectorIndex::sweep_of(const MapWall& wall, const Eigen::Vector2d& eye, double reach,
                                         double shade) {
  if (wall.normal.dot(wall.centre - eye) > reach) return {};  // seen from behind
  Eigen::Vector2d right = wall.centre + (wall.low - shade) * wall.direction() - eye;
  Eigen::Vector2d left = wall.centre + (wall.high + shade) * wall.direction() - eye;
  const double distance = distance_to_segment(right, left);
  if (!(distance > 2.0 * reach)) return {0, kSectors};
  if (cross(right, left) < 0.0) std::swap(right, left);
  const double aside = std::asin(reach / distance) + kRounding;
  const math::Frame outwards({0.0, 0.0, aside}), inwards({0.0, 0.0, -aside});
  const std::size_t first = sector_of(inwards.rotate(right)), last = sector_of(outwards.rotate(left));
  return {first, (last + kSectors - first) % kSectors + 1};
}

SectorIndex::SectorIndex(const std::vector<MapWall>& walls, const Eigen::Vector2d& eye, double reach,
                         double shade) {
  std::vector<Sweep> sweeps;
  sweeps.reserve(walls.size());
  for (const MapWall& wall : walls) sweeps.push_back(sweep_of(wall, eye, reach, shade));
  std::array<std::size_t, kSectors> counts{};
  for (const Sweep& sweep : sweeps)
    for (std::size_t k = 0; k < sweep.count; ++k) ++counts[(sweep.first + k) % kSectors];
  for (std::size_t s = 0; s < kSectors; ++s) first_[s + 1] = first_[s] + counts[s];
  walls_.resize(first_.back());
  std::array<std::size_t, kSectors + 1> next = first_;
  for (std::size_t w = 0; w < sweeps.size(); ++w)
    for (std::size_t k = 0; k < sweeps[w].count; ++k)
      walls_[next[(sweeps[w].first + k) % kSectors]++] = static_cast<std::uint32_t>(w);
}

}  // namespace odomcalib::calib::measurement
