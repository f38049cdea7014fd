#include "tests/sim/world/truth.hpp"

#include <numbers>
#include <random>

namespace odomcalib::sim {

Geometry draw_truth(const Geometry& nominal, std::uint64_t seed) {
  std::mt19937_64 random(seed ^ 0x7472757468ULL);
  const auto error = [&random](double low, double high) {
    const double size = std::uniform_real_distribution<double>(low, high)(random);
    return std::bernoulli_distribution(0.5)(random) ? size : -size;
  };
  const double common = error(0.015, 0.025), difference = error(0.001, 0.005);
  Geometry truth = nominal;
  truth.left_diameter *= 1.0 + common + difference;
  truth.right_diameter *= 1.0 + common - difference;
  truth.track_width *= 1.0 + error(0.01, 0.03);
  truth.lidar.x += error(0.005, 0.020);
  truth.lidar.y += error(0.005, 0.020);
  truth.lidar.yaw += error(0.5, 3.0) * std::numbers::pi / 180.0;
  return truth;
}

}  // namespace odomcalib::sim
