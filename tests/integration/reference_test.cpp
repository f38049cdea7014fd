// Recordings whose reference is a tracker of the base instead of a lidar: many noisy poses, of a marker that
// may sit anywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/solve.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::reference_test {
namespace {

constexpr unsigned kSeed = 2611;

struct Tracker {
  double noise = 2e-3, yaw_noise = 2e-3;  ///< m, rad, of one pose
  std::size_t every = 1;                  ///< samples of the path, 20 ms each
  sim::Pose marker;                       ///< in the frame of the base
};

sim::SimulatedRun run_of(sim::Disturbances disturbances = {}) {
  sim::SimulationConfig config = sim::standard_config(31);
  config.duration = 300.0;
  config.disturbances = std::move(disturbances);
  return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
}

Recording tracked(const sim::SimulatedRun& run, const Tracker& tracker) {
  Recording recording = run.recording;
  recording.scans.clear();
  recording.robot.lidar_pose.reset();
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < run.path.size(); k += tracker.every) {
    const auto& [t, pose, rate] = run.path[k];
    const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
    recording.poses.push_back(
        {t, pose.x + c * tracker.marker.x - s * tracker.marker.y + tracker.noise * normal(engine),
         pose.y + s * tracker.marker.x + c * tracker.marker.y + tracker.noise * normal(engine),
         std::remainder(pose.yaw + tracker.marker.yaw + tracker.yaw_noise * normal(engine), 2.0 * M_PI)});
  }
  return recording;
}

const Quantity& parameter(const Calibration& found, const std::string& name) {
  for (const auto& [own, quantity] : found.parameters)
    if (own == name) return quantity;
  throw std::out_of_range(name);
}

void expect_lengths(const Calibration& found, const sim::Geometry& truth) {
  const std::pair<const char*, double> lengths[] = {{"left_wheel_diameter", truth.left_diameter},
                                                    {"right_wheel_diameter", truth.right_diameter},
                                                    {"track_width", truth.track_width}};
  for (const auto& [name, value] : lengths) {
    const Quantity& q = parameter(found, name);
    EXPECT_NEAR(q.value, value, 3.0 * q.std) << name << ", seed " << kSeed;
    EXPECT_LT(q.std, 1e-3 * value) << name;
  }
}

TEST(Reference, all_poses_count_not_only_those_of_keyframes) {
  const auto run = run_of();
  const Calibration found = calib::solve(std::vector{tracked(run, {})}, {});
  EXPECT_EQ(found.verdict, Verdict::accepted) << (found.reasons.empty() ? "" : found.reasons[0]);
  EXPECT_TRUE(found.effects.empty() && !found.unexplained);
  expect_lengths(found, run.truth);
  // Two single poses leave 2.8 mm along x.
  EXPECT_LT((*found.residual.after)[0], 1.2e-3);
  EXPECT_EQ(parameter(found, "lidar_x").value, 0.0) << "the tracker follows the middle of the axle";
}

TEST(Reference, a_localiser_of_seven_poses_a_second_will_do) {
  const auto run = run_of();
  const Calibration found = calib::solve(std::vector{tracked(run, {6e-3, 5e-3, 7, {}})}, {});
  EXPECT_NE(found.verdict, Verdict::refused) << found.reasons[0];
  EXPECT_TRUE(found.effects.empty() && !found.unexplained);
  expect_lengths(found, run.truth);
}

TEST(Reference, a_marker_beside_the_axle_is_no_effect_of_the_robot) {
  const sim::Pose marker{0.012, -0.005, 0.02};
  const auto run = run_of();
  const Calibration found = calib::solve(std::vector{tracked(run, {.marker = marker})}, {});
  EXPECT_NE(found.verdict, Verdict::refused) << found.reasons[0];
  EXPECT_TRUE(found.effects.empty() && !found.unexplained);
  expect_lengths(found, run.truth);
  EXPECT_NEAR(parameter(found, "lidar_x").value, marker.x, 1e-3);
  EXPECT_NEAR(parameter(found, "lidar_y").value, marker.y, 1e-3);
  EXPECT_NEAR(parameter(found, "lidar_yaw").value, marker.yaw, 3e-3);
}

TEST(Reference, an_effect_that_hides_in_single_poses_is_named) {
  sim::Random random(kSeed);
  const auto run = run_of({sim::find_effect("cornering_creep")->make(0.04, random)});
  const Calibration found = calib::solve(std::vector{tracked(run, {})}, {});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].name, "lateral_slip");
  expect_lengths(found, run.truth);
}

TEST(Reference, scans_without_beam_times_of_a_head_that_turns_are_skewed) {
  auto run = run_of();
  Recording recording = run.recording;
  for (Scan& scan : recording.scans) {
    scan.time_increment.reset();
    scan.times.clear();
  }
  const Calibration found = calib::solve(std::vector{recording}, {});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].name, "scan_skew");
  EXPECT_NEAR(std::abs(found.effects[0].parameters[0].second.value), 0.1 / (2.0 * M_PI), 5e-4)
      << "of a head that turns ten times a second";
  EXPECT_LT(found.effects[0].evidence.p_value, 1e-6);
  expect_lengths(found, run.truth);
}

}  // namespace
}  // namespace odomcalib::reference_test
