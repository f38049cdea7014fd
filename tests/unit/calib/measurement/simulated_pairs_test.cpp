// The first pairs of the simulated sets against the least error that any estimator could have.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "calib/match.hpp"
#include "calib/math/se2.hpp"
#include "tests/unit/calib/scan_pairs.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::calib::measurement::simulated_pairs_test {
namespace {

struct Score {
  std::size_t pairs = 0, good = 0, outside = 0;
  double squares = 0.0, bound_squares = 0.0;
  [[nodiscard]] double ratio() const { return std::sqrt(squares / bound_squares); }
};

void add(Score& score, const test_support::ScanPair& pair, const ScanMatch& match) {
  constexpr double kChiSquare99 = 11.345;  // three degrees of freedom
  ++score.pairs;
  if (!match.ok()) return;
  const Eigen::Vector3d error(match.pose[0] - pair.truth[0], match.pose[1] - pair.truth[1],
                              math::wrap_angle(match.pose[2] - pair.truth[2]));
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      covariance(i, j) = match.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  if (error.dot(covariance.inverse() * error) > kChiSquare99) ++score.outside;
  if (error.head<2>().norm() > 0.05 || std::abs(error(2)) > math::kPi / 180.0) return;
  ++score.good;
  score.squares += error.head<2>().squaredNorm();
  score.bound_squares += pair.translation_bound() * pair.translation_bound();
}

constexpr double kOwnNoise = 0.01;  // m, of the ranges as they are

/// Ranges with so much noise altogether; the bound grows with it.
void make_noisy(test_support::ScanPair& pair, double noise, std::mt19937& random) {
  std::normal_distribution<double> further(0.0, std::sqrt(noise * noise - kOwnNoise * kOwnNoise));
  for (Scan* scan : {&pair.reference, &pair.scan})
    for (float& range : scan->ranges)
      if (range > 0.0F) range += static_cast<float>(further(random));
  pair.information *= kOwnNoise * kOwnNoise / (noise * noise);
}

Score score_of(const std::string& name, double noise) {
  constexpr std::size_t kPairs = 40;
  constexpr unsigned kSeed = 5;
  auto pairs = test_support::read_scan_pairs(test_support::shared_data("scanmatch") / (name + ".smp.gz"));
  pairs.resize(std::min(pairs.size(), kPairs));
  std::mt19937 random(kSeed);
  Score score;
  for (test_support::ScanPair& pair : pairs) {
    if (noise > kOwnNoise) make_noisy(pair, noise, random);
    add(score, pair, match_scans(pair.reference, pair.scan, pair.guess));
  }
  EXPECT_GT(score.pairs, 30U) << name;
  return score;
}

void expect_near_the_bound(const std::string& name, double ratio, double noise = kOwnNoise) {
  const Score score = score_of(name, noise);
  EXPECT_EQ(score.good, score.pairs) << name;
  EXPECT_LT(score.ratio(), ratio) << name;
  EXPECT_LE(score.outside, 3U) << name << ": 1 % expected outside of the 99 % ellipse";
}

TEST(SimulatedPairs, errors_stay_near_the_bound_and_inside_the_stated_ellipse) {
  ODOMCALIB_NEEDS_SHARED("scanmatch");
  expect_near_the_bound("sim720-small", 1.35);
  expect_near_the_bound("sim720-large", 1.35);
  expect_near_the_bound("sim720-changed", 1.35);
  expect_near_the_bound("sim1081-small", 1.25);
}

TEST(SimulatedPairs, beams_that_lie_closer_together_than_their_noise_still_see_walls) {
  ODOMCALIB_NEEDS_SHARED("scanmatch");
  expect_near_the_bound("sim1081-small", 2.0, 0.03);
  expect_near_the_bound("sim1081-large", 2.0, 0.03);
  expect_near_the_bound("sim720-small", 2.0, 0.03);
}

TEST(SimulatedPairs, a_motion_of_a_metre_and_45_degrees_is_found_without_a_guess) {
  ODOMCALIB_NEEDS_SHARED("scanmatch");
  expect_near_the_bound("sim720-loop", 1.5);
}

}  // namespace
}  // namespace odomcalib::calib::measurement::simulated_pairs_test
