#include "calib/measurement/sector_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "calib/measurement/wall_map.hpp"

namespace odomcalib::calib::measurement::sector_index_test {
namespace {

constexpr double kReach = 0.15, kShade = 0.1;  // m
constexpr unsigned kSeed = 20261122;

class RandomWalls {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Eigen::Vector2d direction() {
    const double angle = between(-math::kPi, math::kPi);
    return {std::cos(angle), std::sin(angle)};
  }
  std::vector<MapWall> walls(std::size_t count) {
    std::vector<MapWall> all(count);
    for (MapWall& wall : all) {
      wall.centre = {between(-5.0, 5.0), between(-5.0, 5.0)};
      wall.normal = direction();
      wall.low = between(-3.0, 0.0);
      wall.high = between(0.0, 3.0);
    }
    return all;
  }

 private:
  std::mt19937 engine_{kSeed};
};

TEST(SectorIndex, holds_every_wall_that_a_beam_can_strike) {
  RandomWalls random;
  int strikes = 0;
  for (int room = 0; room < 200; ++room) {
    const auto walls = random.walls(30);
    const Eigen::Vector2d eye(random.between(-5.0, 5.0), random.between(-5.0, 5.0));
    const SectorIndex index(walls, eye, kReach, kShade);
    for (std::uint32_t w = 0; w < walls.size(); ++w)
      for (int shot = 0; shot < 30; ++shot) {
        const Eigen::Vector2d from = eye + random.between(0.0, kReach) * random.direction();
        const double along = random.between(walls[w].low - kShade, walls[w].high + kShade);
        const Eigen::Vector2d way = walls[w].centre + along * walls[w].direction() - from;
        if (walls[w].normal.dot(way) >= 0.0) continue;  // from behind no beam strikes it
        const auto near = index.towards(way);
        ASSERT_TRUE(std::binary_search(near.begin(), near.end(), w))
            << "seed " << kSeed << " room " << room << " wall " << w << " shot " << shot;
        ++strikes;
      }
  }
  EXPECT_GT(strikes, 50000);
}

TEST(SectorIndex, leaves_out_most_walls_that_lie_elsewhere) {
  RandomWalls random;
  const auto walls = random.walls(100);
  const SectorIndex index(walls, {0.0, 0.0}, kReach, kShade);
  std::size_t kept = 0;
  constexpr std::size_t kBeams = 360;
  for (std::size_t k = 0; k < kBeams; ++k) kept += index.towards(random.direction()).size();
  EXPECT_LT(kept, kBeams * walls.size() / 5);
  EXPECT_GT(kept, kBeams);
}

TEST(SectorIndex, of_no_walls_is_empty) {
  const SectorIndex index({}, {0.0, 0.0}, 0.0, kShade);
  EXPECT_TRUE(index.towards({1.0, 0.0}).empty());
}

}  // namespace
}  // namespace odomcalib::calib::measurement::sector_index_test
