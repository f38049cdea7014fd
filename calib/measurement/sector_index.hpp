// Index of the walls that a beam may strike, by the way it points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace odomcalib::calib::measurement {

struct MapWall;

/// Walls as seen from one place, sorted into sectors of direction; each wall is in all sectors in which a
/// beam can strike it, and maybe in a few more.
class SectorIndex {
 public:
  /// @param eye m, in the map
  /// @param reach m, from the eye to the farthest origin of a beam
  /// @param shade m, that walls are longer by at either end
  SectorIndex(const std::vector<MapWall>& walls, const Eigen::Vector2d& eye, double reach, double shade);

  /// @param direction in the map, of any length but zero
  /// @return numbers of walls, ascending
  [[nodiscard]] std::span<const std::uint32_t> towards(const Eigen::Vector2d& direction) const {
    const std::size_t sector = sector_of(direction);
    return {walls_.data() + first_[sector], walls_.data() + first_[sector + 1]};
  }

 private:
  static constexpr std::size_t kSectors = 64;

  /// Run of `count` sectors from `first` on, counter-clockwise.
  struct Sweep {
    std::size_t first = 0, count = 0;
  };
  static Sweep sweep_of(const MapWall& wall, const Eigen::Vector2d& eye, double reach, double shade);

  static std::size_t sector_of(const Eigen::Vector2d& direction);

  std::vector<std::uint32_t> walls_;  ///< of sector after sector
  std::array<std::size_t, kSectors + 1> first_{};
};

}  // namespace odomcalib::calib::measurement
