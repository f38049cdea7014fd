#include "tests/sim/world/simulate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim::simulate_test {
namespace {

constexpr double kPi = std::numbers::pi;

SimulationConfig short_config() {
  SimulationConfig config = standard_config(11);
  config.duration = 5.0;
  return config;
}

TEST(Simulate, records_50_tick_samples_and_ten_sweeps_of_450_beams_a_second) {
  const SimulatedRun run = simulate_recording(short_config(), follow({}, guided_pattern()));
  EXPECT_EQ(run.recording.ticks.size(), 251U);
  EXPECT_EQ(run.recording.scans.size(), 49U);
  for (const Scan& scan : run.recording.scans) {
    EXPECT_EQ(scan.ranges.size(), 450U);
    EXPECT_NEAR(scan.angle_increment, -2.0 * kPi / 450.0, 1e-12);
    EXPECT_NEAR(*scan.time_increment, 1.0 / (450.0 * 9.97), 1e-12);
  }
  EXPECT_NEAR(run.recording.scans[1].t - run.recording.scans[0].t, 1.0 / 9.97, 1e-9);
}

TEST(Simulate, is_deterministic_and_depends_on_the_seed) {
  SimulationConfig config = short_config();
  const auto once = simulate_recording(config, random_drive({}, 5));
  const auto again = simulate_recording(config, random_drive({}, 5));
  config.seed = 12;
  const auto other = simulate_recording(config, random_drive({}, 5));
  ASSERT_EQ(once.recording.scans.size(), again.recording.scans.size());
  for (std::size_t i = 0; i < once.recording.scans.size(); ++i)
    EXPECT_EQ(once.recording.scans[i].ranges, again.recording.scans[i].ranges);
  EXPECT_EQ(once.recording.ticks.back().left, again.recording.ticks.back().left);
  EXPECT_NE(once.recording.scans[3].ranges, other.recording.scans[3].ranges);
}

TEST(Simulate, gives_the_drive_the_pose_that_nominal_odometry_believes_in) {
  SimulationConfig config = short_config();
  config.truth = config.nominal;
  config.body.slip_noise = 0.0;
  Pose believed;
  const Drive circle = [&](double, const Pose& odometry) {
    believed = odometry;
    return wheel_command(config.nominal, 0.2, 0.5);
  };
  const auto run = simulate_recording(config, circle);
  const Pose& truth = run.path.back().pose;
  EXPECT_NEAR(believed.x, truth.x, 1e-3);
  EXPECT_NEAR(believed.y, truth.y, 1e-3);
  EXPECT_NEAR(believed.yaw, truth.yaw, 1e-3);
}

/// Dead reckoning by exact arcs: another discretisation than that of the simulated body.
Pose dead_reckoning(const std::vector<TickSample>& ticks, const Geometry& robot) {
  Pose pose;
  const double radian = 2.0 * kPi / robot.ticks_per_rev;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double left =
        0.5 * robot.left_diameter * radian * static_cast<double>(ticks[i].left - ticks[i - 1].left);
    const double right =
        0.5 * robot.right_diameter * radian * static_cast<double>(ticks[i].right - ticks[i - 1].right);
    const double turn = (right - left) / robot.track_width, way = 0.5 * (left + right);
    const double chord = std::abs(turn) < 1e-9 ? way : way / turn * 2.0 * std::sin(0.5 * turn);
    pose.x += chord * std::cos(pose.yaw + 0.5 * turn);
    pose.y += chord * std::sin(pose.yaw + 0.5 * turn);
    pose.yaw += turn;
  }
  return pose;
}

TEST(Simulate, ticks_and_true_dimensions_give_the_true_path_and_nominal_dimensions_do_not) {
  SimulationConfig config = standard_config(21);
  config.body.slip_noise = 0.0;
  config.lidar.beams_per_turn = 10;
  const auto run = simulate_recording(config, follow(config.nominal, guided_pattern()));
  const Pose& truth = run.path.back().pose;
  const Pose by_truth = dead_reckoning(run.recording.ticks, config.truth);
  EXPECT_NEAR(by_truth.x, truth.x, 0.002);
  EXPECT_NEAR(by_truth.y, truth.y, 0.002);
  EXPECT_NEAR(by_truth.yaw, truth.yaw, 0.001);
  const Pose by_nominal = dead_reckoning(run.recording.ticks, config.nominal);
  EXPECT_GT(std::hypot(by_nominal.x - truth.x, by_nominal.y - truth.y), 0.02);
}

TEST(Simulate, every_beam_ends_on_a_wall_as_seen_from_the_true_pose_at_its_time) {
  SimulationConfig config = standard_config(22);
  config.duration = 40.0;
  config.lidar.range_noise = 0.0;
  config.truth_period = 0.001;
  const auto run = simulate_recording(config, follow(config.nominal, guided_pattern()));
  for (std::size_t i = 0; i < run.recording.scans.size(); i += 7) {
    const Scan& scan = run.recording.scans[i];
    for (std::size_t k = 0; k < scan.ranges.size(); k += 11) {
      if (scan.ranges[k] == 0.0F) continue;
      const double t = scan.t + *scan.time_increment * static_cast<double>(k);
      const Pose base = run.path[static_cast<std::size_t>(std::lround(t * 1000.0))].pose;
      const Pose eye = compose(base, config.truth.lidar);
      const double direction = eye.yaw + scan.angle(k), range = static_cast<double>(scan.ranges[k]);
      const Vec2 end{eye.x + range * std::cos(direction), eye.y + range * std::sin(direction)};
      EXPECT_LT(config.room.clearance(end), 0.006)
          << "scan " << i << " beam " << k;  // 0.5 ms at 4 m and 1.3 rad/s
    }
  }
}

TEST(Simulate, true_dimensions_differ_from_the_nominal_ones_by_one_to_three_percent) {
  const Geometry nominal;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Geometry truth = draw_truth(nominal, seed);
    for (const double ratio :
         {truth.left_diameter / nominal.left_diameter, truth.right_diameter / nominal.right_diameter,
          truth.track_width / nominal.track_width}) {
      EXPECT_GE(std::abs(ratio - 1.0), 0.0099) << "seed " << seed;
      EXPECT_LE(std::abs(ratio - 1.0), 0.0301) << "seed " << seed;
    }
    EXPECT_NE(truth.left_diameter, truth.right_diameter);
  }
}

TEST(Simulate, drives_stay_clear_of_the_walls) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SimulationConfig config = standard_config(seed);
    config.lidar.beams_per_turn = 10;
    EXPECT_GT(simulate_recording(config, follow(config.nominal, guided_pattern())).least_clearance, 0.5)
        << seed;
    EXPECT_GT(simulate_recording(config, random_drive(config.nominal, seed)).least_clearance, 0.3) << seed;
    config.room = random_room(seed);
    EXPECT_GT(simulate_recording(config, random_drive(config.nominal, seed)).least_clearance, 0.2) << seed;
  }
}

TEST(Simulate, a_random_drive_that_has_come_too_far_comes_back) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SimulationConfig config = standard_config(seed);
    config.lidar.beams_per_turn = 10;
    config.duration = 600.0;
    const auto path = simulate_recording(config, random_drive(config.nominal, seed, 0.9)).path;
    double way = 0.0;
    for (std::size_t k = path.size() * 3 / 4; k + 1 < path.size(); ++k)
      way += std::hypot(path[k + 1].pose.x - path[k].pose.x, path[k + 1].pose.y - path[k].pose.y);
    EXPECT_GT(way, 10.0) << "m in the last 150 s, seed " << seed;
  }
}

TEST(Simulate, a_tour_goes_forward_only_and_stays_where_odometry_says_it_may) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SimulationConfig config = standard_config(seed);
    config.lidar.beams_per_turn = 10;
    config.duration = 300.0;
    double farthest = 0.0;
    const Drive watched = [&, tour = tour_drive(config.nominal, seed)](double t, const Pose& odometry) {
      farthest = std::max(farthest, std::hypot(odometry.x, odometry.y));
      return tour(t, odometry);
    };
    const auto path = simulate_recording(config, watched).path;
    double ahead = 0.0, back = 0.0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      const Pose &a = path[k].pose, &b = path[k + 1].pose;
      const double step = std::cos(a.yaw) * (b.x - a.x) + std::sin(a.yaw) * (b.y - a.y);
      (step > 0.0 ? ahead : back) += std::abs(step);
    }
    EXPECT_GT(ahead, 30.0) << "m, seed " << seed;
    EXPECT_LT(back, 0.01 * ahead) << "m, seed " << seed;
    EXPECT_LT(farthest, 2.5) << "m, seed " << seed;
  }
}

TEST(Simulate, guided_pattern_excites_both_signs_of_everything_in_about_five_minutes) {
  const double duration = total_duration(guided_pattern());
  EXPECT_GT(duration, 240.0);
  EXPECT_LT(duration, 360.0);
}

TEST(Simulate, varied_pattern_passes_all_speeds_slowly_and_comes_home) {
  const std::vector<Manoeuvre> pattern = varied_pattern();
  EXPECT_GT(total_duration(pattern), 270.0);
  EXPECT_LE(total_duration(pattern), 300.0);
  double way = 0.0, fastest_sweep = 0.0;
  std::set<double> rests;
  for (const Manoeuvre& move : pattern) {
    way += way_of(move);
    if (move.speed == 0.0 && move.yaw_rate == 0.0) rests.insert(move.duration);
    if (move.from == 0.0 && move.duration > 2.0) fastest_sweep = std::max(fastest_sweep, move.speed);
  }
  EXPECT_NEAR(way, 0.0, 1e-9);
  EXPECT_GE(fastest_sweep, 0.5);
  EXPECT_GE(rests.size(), 5U);
}

TEST(Simulate, four_minutes_take_less_than_three_seconds) {
  SimulationConfig config = standard_config(1);
  config.duration = 240.0;
  const auto start = std::chrono::steady_clock::now();
  const auto run = simulate_recording(config, follow(config.nominal, guided_pattern()));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  RecordProperty("seconds", std::to_string(took.count()));
  EXPECT_LT(took.count(), 12.0)
      << "3 s on an idle core; the bound leaves room for a loaded machine or a sanitizer";
  EXPECT_GT(run.recording.scans.size(), 2380U);
}

}  // namespace
}  // namespace odomcalib::sim::simulate_test
