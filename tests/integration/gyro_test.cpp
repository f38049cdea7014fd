// A gyro on the simulated robot, in a room that a lidar of short range hardly sees.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::gyro_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kScale = 1.02;

/// Wheels that slip a little at every step, and a lidar that sees three metres far: little of the room, and
/// nothing at all in the middle of it.
sim::SimulatedRun poor_run(std::uint64_t seed) {
  sim::SimulationConfig config = sim::standard_config(seed);
  config.duration = 120.0;
  config.body.slip_noise = 0.003;
  config.lidar.range_max = 3.2;
  return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
}

/// 0.1 deg/s of noise, 2 % of scale.
std::vector<GyroSample> gyro_of(const sim::SimulatedRun& run, double scale, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.1 * kDegree);
  std::vector<GyroSample> samples;
  for (std::size_t k = 1; k < run.path.size(); ++k) {
    const double dt = run.path[k].t - run.path[k - 1].t;
    const double turn =
        std::remainder(run.path[k].pose.yaw - run.path[k - 1].pose.yaw, 2.0 * std::numbers::pi);
    samples.push_back({run.path[k - 1].t + dt / 2.0, scale * turn / dt + noise(random)});
  }
  return samples;
}

Calibration solved(const Recording& recording) {
  calib::SolveOptions options;
  options.effects = {"none"};
  return calib::solve({&recording, 1}, options);
}

const Quantity& track(const Calibration& calibration) { return calibration.parameters[2].second; }

TEST(Gyro, S2_40_lowers_the_deviation_of_the_track_where_the_lidar_sees_little) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    sim::SimulatedRun run = poor_run(seed);
    const Calibration without = solved(run.recording);
    run.recording.gyro = gyro_of(run, kScale, seed);
    const Calibration with = solved(run.recording);
    ASSERT_EQ(without.parameters.size(), 6U) << without.reasons[0];
    ASSERT_EQ(with.parameters.size(), 6U) << with.reasons[0];
    std::printf("track: %+.4f mm off, +- %.4f without, %+.4f +- %.4f with\n",
                1e3 * (track(without).value - run.truth.track_width), 1e3 * track(without).std,
                1e3 * (track(with).value - run.truth.track_width), 1e3 * track(with).std);
    EXPECT_LT(track(with).std, track(without).std);
    EXPECT_LT(std::abs(track(with).value - run.truth.track_width), 3.0 * track(with).std);
  }
}

TEST(Gyro, S2_40_with_a_reversed_sign_is_named_and_left_out) {
  sim::SimulatedRun run = poor_run(1);
  const Calibration without = solved(run.recording);
  run.recording.gyro = gyro_of(run, -kScale, 1);
  const Calibration with = solved(run.recording);
  EXPECT_EQ(track(with).value, track(without).value);
  EXPECT_EQ(track(with).std, track(without).std);
  std::string reasons;
  for (const std::string& reason : with.reasons) reasons += reason + "\n";
  EXPECT_NE(reasons.find("its sign is reversed"), std::string::npos) << reasons;
}

}  // namespace
}  // namespace odomcalib::gyro_test
