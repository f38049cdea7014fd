#include "tests/sim/world/ray_bound.hpp"

#include <gtest/gtest.h>

namespace odomcalib::sim::ray_bound_test {
namespace {

SimulationConfig short_config(double range_noise, double slip) {
  SimulationConfig config = standard_config(1);
  config.duration = 20.0;
  config.lidar.range_noise = range_noise;
  config.lidar.resolution = 0.0;
  config.body.slip_noise = slip;
  return config;
}

std::array<double, kLearned> bound_of(const SimulationConfig& config) {
  return ray_bound(config, simulate_recording(config, random_drive(config.nominal, 1)));
}

TEST(RayBound, without_slip_it_is_proportional_to_the_range_noise) {
  const auto fine = bound_of(short_config(0.004, 0.0));
  const auto coarse = bound_of(short_config(0.008, 0.0));
  for (std::size_t k = 0; k < kLearned; ++k) EXPECT_NEAR(coarse[k] / fine[k], 2.0, 0.02) << k;
}

TEST(RayBound, slip_and_less_time_make_it_worse) {
  const auto ideal = bound_of(short_config(0.008, 0.0));
  const auto slipping = bound_of(short_config(0.008, 0.0004));
  SimulationConfig brief = short_config(0.008, 0.0004);
  brief.duration = 10.0;
  const auto less = bound_of(brief);
  for (std::size_t k = 0; k < kLearned; ++k) {
    EXPECT_GT(ideal[k], 0.0) << k;
    EXPECT_GT(slipping[k], ideal[k]) << k;
    EXPECT_GT(less[k], slipping[k]) << k;
  }
}

// By hand: a wheel that slips by s per root of a metre is known to s / sqrt(d) of its size after d metres, if
// nothing else disturbs; twenty seconds of wandering are not more than ten metres.
TEST(RayBound, slip_alone_limits_the_diameters) {
  const auto bound = bound_of(short_config(1e-4, 0.01));
  EXPECT_GT(bound[0], 0.15 * 0.01 / std::sqrt(10.0));
  EXPECT_LT(bound[0], 0.15 * 0.01 * 2.0);
}

}  // namespace
}  // namespace odomcalib::sim::ray_bound_test
