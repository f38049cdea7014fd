// Places of scans in a map and of poses, and what the wheels may say about them.
#include "calib/measurement/placed_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace odomcalib::calib::measurement::placed_scan_test {
namespace {

constexpr unsigned kSeed = 2112;
constexpr double kNoise = 2e-3;   // m and rad
constexpr double kPeriod = 0.05;  // s

/// An arc that is driven faster and faster.
math::Pose truth(double time) {
  const double a = 0.05 * time * time;
  return {2.0 * std::sin(a), 2.0 - 2.0 * std::cos(a), a};
}

/// Wheels that are a hundredth too large.
math::Pose worn(double time) {
  const double a = 1.01 * 0.05 * time * time;
  return {2.0 * std::sin(a), 2.0 - 2.0 * std::cos(a), a};
}

std::vector<PlacedScan> places(double noise, unsigned seed = kSeed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> gauss(0.0, noise);
  std::vector<PlacedScan> all;
  for (double t = 0.0; t < 8.0; t += kPeriod) {
    math::Pose pose = truth(t);
    for (double* part : {&pose.x, &pose.y, &pose.yaw}) *part += gauss(engine);
    all.push_back({t, pose, noise * noise * Eigen::Matrix3d::Identity()});
  }
  return all;
}

double distance(const math::Pose& a, const math::Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(MeanPlace, errs_by_what_twenty_scans_leave) {
  double sum = 0.0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto mean = mean_place(places(kNoise, seed), 4.02, truth);
    ASSERT_TRUE(mean);
    sum += std::pow(distance(mean->pose, truth(4.02)), 2);
    EXPECT_NEAR(std::sqrt(mean->covariance(0, 0)), kNoise / std::sqrt(20.0), 1e-9);
  }
  EXPECT_NEAR(std::sqrt(sum / 400.0), kNoise / std::sqrt(20.0), 0.1 * kNoise / std::sqrt(20.0))
      << "seeds 0..199";
}

TEST(MeanPlace, forgives_the_wheels_what_they_do_before_and_after) {
  const auto mean = mean_place(places(0.0), 4.02, worn);
  ASSERT_TRUE(mean);
  // Over half a second the wheels err by 2 mm; the mean by what the speed's change leaves of it.
  EXPECT_GT(distance(worn(4.5), compose(worn(4.0), between(truth(4.0), truth(4.5)))), 1.9e-3);
  EXPECT_LT(distance(mean->pose, truth(4.02)), 2e-4);
}

TEST(MeanPlace, reaches_as_far_as_it_is_told) {
  const auto mean = mean_place(places(kNoise), 4.02, truth, 0.1);
  ASSERT_TRUE(mean);
  EXPECT_NEAR(std::sqrt(mean->covariance(0, 0)), kNoise / 2.0, 1e-9) << "four scans";
  EXPECT_FALSE(mean_place(places(0.0), 4.02, truth, 0.01));
}

TEST(MeanPlace, needs_scans_nearby) {
  std::vector<PlacedScan> few = places(0.0);
  std::erase_if(few, [](const PlacedScan& scan) { return std::abs(scan.time - 4.0) < 0.42; });
  EXPECT_TRUE(mean_place(few, 4.0, truth));
  std::erase_if(few, [](const PlacedScan& scan) { return std::abs(scan.time - 4.0) < 0.6; });
  EXPECT_FALSE(mean_place(few, 4.0, truth));
  EXPECT_FALSE(mean_place({}, 4.0, truth));
}

TEST(PlaceAt, is_that_of_the_nearest_scan_carried_there) {
  std::vector<PlacedScan> all = places(0.0);
  EXPECT_LT(distance(place_at(all, 4.02, truth)->pose, truth(4.02)), 1e-12);
  EXPECT_LT(distance(place_at(all, -0.1, truth)->pose, truth(-0.1)), 1e-12);
  EXPECT_FALSE(place_at(all, -0.2, truth));
  std::erase_if(all, [](const PlacedScan& scan) { return std::abs(scan.time - 4.0) < 0.16; });
  EXPECT_FALSE(place_at(all, 4.0, truth));
  EXPECT_FALSE(place_at({}, 4.0, truth));
}

TEST(MotionBetween, is_that_of_the_sensor_in_its_own_frame) {
  const auto all = places(0.0);
  const PlacedMotion motion = motion_between(all[10], all[50]);
  const math::Pose end = compose(all[10].pose, motion.motion);
  EXPECT_LT(distance(end, all[50].pose), 1e-12);
  EXPECT_NEAR(end.yaw, all[50].pose.yaw, 1e-12);
}

/// As a tracker gives them: every 20 ms, headings between -pi and pi.
std::vector<PoseSample> poses(double noise) {
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> gauss(0.0, noise);
  std::vector<PoseSample> all;
  for (double t = 0.0; t < 12.0; t += 0.02) {
    const math::Pose pose = truth(t);
    all.push_back(
        {t, pose.x + gauss(engine), pose.y + gauss(engine), math::wrap_angle(pose.yaw + gauss(engine))});
  }
  return all;
}

TEST(PlacedPoses, average_their_noise_along_the_path_of_the_wheels) {
  auto places = placed_poses(poses(kNoise), worn);
  places.pop_back();  // what was left over
  ASSERT_NEAR(static_cast<double>(places.size()), 110.0, 12.0) << "five or six poses each";
  double squares = 0.0;
  for (const PlacedScan& place : places) {
    squares += std::pow(place.pose.x - truth(place.time).x, 2);
    EXPECT_NEAR(std::sqrt(place.covariance(0, 0)), kNoise / std::sqrt(5.0), 0.15e-3) << "seed " << kSeed;
    EXPECT_NEAR(std::sqrt(place.covariance(2, 2)), kNoise / std::sqrt(5.0), 0.15e-3) << "seed " << kSeed;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(places.size())), 1.2 * kNoise / std::sqrt(5.0));
}

TEST(PlacedPoses, go_on_beyond_half_a_turn) {
  const auto places = placed_poses(poses(1e-4), truth);
  ASSERT_GT(truth(11.9).yaw, 2.0 * math::kPi);
  EXPECT_NEAR(places.back().pose.yaw, truth(places.back().time).yaw, 1e-3);
}

TEST(PlacedPoses, a_gap_is_no_noise_and_few_are_none) {
  std::vector<PoseSample> interrupted = poses(kNoise);
  interrupted.erase(interrupted.begin() + 200, interrupted.begin() + 400);
  EXPECT_NEAR(std::sqrt(placed_poses(interrupted, truth).front().covariance(0, 0)), kNoise / std::sqrt(5.0),
              0.3e-3);
  EXPECT_TRUE(placed_poses({}, truth).empty());
  EXPECT_EQ(placed_poses(std::vector{interrupted[0], interrupted[1]}, truth).size(), 1U);
}

}  // namespace
}  // namespace odomcalib::calib::measurement::placed_scan_test
