// Matches that slide are told from matches that only scatter, by the scans' places in the map.
#include "calib/measurement/scan_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace odomcalib::calib::measurement::placed_pairs_test {
namespace {

constexpr unsigned kSeed = 90125;
constexpr double kNoise = 1e-3;  // m and rad
constexpr std::size_t kScans = 400;

/// A loop walk through a room.
math::Pose walk(double time) {
  const double a = 0.1 * time;
  return {2.0 * std::cos(a), 1.5 * std::sin(a), a + 0.3 * std::sin(3.0 * a)};
}

/// Every scan placed.
ScanPath some_path() {
  ScanPath path;
  for (std::size_t k = 0; k < kScans; ++k) {
    const double t = 0.5 * static_cast<double>(k);
    path.scans.push_back({t, walk(t), 1e-8 * Eigen::Matrix3d::Identity()});
  }
  return path;
}

/// @param slide m of every match along the map's y axis
std::vector<SensorPair> matches_along(const ScanPath& path, double slide) {
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<SensorPair> pairs;
  for (std::size_t k = 0; k + 1 < path.scans.size(); ++k) {
    const PlacedScan &a = path.scans[k], &b = path.scans[k + 1];
    math::Pose end = b.pose;
    end.y += slide;
    const math::Pose m = between(a.pose, end);
    pairs.push_back({{a.time, b.time},
                     {m.x + noise(engine), m.y + noise(engine), m.yaw + noise(engine)},
                     kNoise * kNoise * Eigen::Matrix3d::Identity(),
                     k > 0});
  }
  return pairs;
}

TEST(PlacedPairs, scatter_is_no_drift_and_sliding_is) {
  const ScanPath path = some_path();
  EXPECT_LT(drift_of_matches(matches_along(path, 0.0), path, walk), 4.0) << "seed " << kSeed;
  EXPECT_GT(drift_of_matches(matches_along(path, 0.5 * kNoise), path, walk), 6.0) << "seed " << kSeed;
}

TEST(PlacedPairs, motions_are_those_from_place_to_place) {
  ScanPath path = some_path();
  const auto matches = matches_along(path, 0.01);
  path.scans.erase(path.scans.begin() + 100);
  const auto pairs = pairs_of_places(matches, path, walk);
  ASSERT_EQ(pairs.size(), matches.size() - 2) << "two pairs have lost a place";
  for (const SensorPair& pair : pairs) EXPECT_NEAR(std::hypot(pair.motion.x, pair.motion.y), 0.09, 0.03);
  EXPECT_TRUE(pairs[98].follows_previous);
  EXPECT_FALSE(pairs[99].follows_previous) << "across the gap";
  // Two places of 0.1 mm each, and the heading of the first over a lever of some centimetres.
  EXPECT_NEAR(std::sqrt(pairs[0].covariance(0, 0)), std::sqrt(2.0) * 1e-4, 2e-5);
  EXPECT_NEAR(std::sqrt(pairs[0].covariance(2, 2)), std::sqrt(2.0) * 1e-4, 1e-9);
}

TEST(PlacedPairs, without_places_there_is_nothing_to_say) {
  const ScanPath path = some_path();
  EXPECT_EQ(drift_of_matches(matches_along(path, 0.01), ScanPath{}, walk), 0.0);
  EXPECT_TRUE(pairs_of_places(matches_along(path, 0.01), ScanPath{}, walk).empty());
}

}  // namespace
}  // namespace odomcalib::calib::measurement::placed_pairs_test
