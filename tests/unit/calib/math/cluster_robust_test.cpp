// How far a mean may be trusted whose errors are correlated: over neighbours, over minutes, or not at all.
#include "calib/math/cluster_robust.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace odomcalib::calib::math::cluster_robust_test {
namespace {

constexpr int kSamples = 2000;  ///< one a second
constexpr unsigned kSeeds = 200;

/// Stated deviation of a mean of errors with unit variance over its true one if they were independent. Errors
/// are the sum of white noise and of steps that last for `lasting` s.
double stated_over_white(unsigned seed, double step, int lasting) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const double share = step * step;
  ClusterRobust robust(Eigen::MatrixXd::Constant(1, 1, 1.0 / kSamples));
  double drift = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    if (k % lasting == 0) drift = step * normal(engine);
    robust.add(k, Eigen::VectorXd::Constant(1, std::sqrt(1.0 - share) * normal(engine) + drift));
  }
  robust.end_recording();
  return std::sqrt(robust.inflated(1.0)(0, 0) * kSamples);
}

double mean_ratio(double step, int lasting) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) sum += stated_over_white(seed, step, lasting) / kSeeds;
  return sum;
}

TEST(ClusterRobust, white_errors_keep_the_deviation_of_the_model) {
  EXPECT_NEAR(mean_ratio(0.0, 1), 1.03, 0.03) << "never below the model, seldom above it";
}

TEST(ClusterRobust, errors_that_last_for_a_block_count_once_a_block) {
  // Variance of a sum of n equal errors is n times that of independent ones.
  EXPECT_NEAR(mean_ratio(0.5, 5), std::sqrt(0.75 + 0.25 * 5.0), 0.15);
}

TEST(ClusterRobust, a_drift_that_is_much_longer_than_a_block_is_found) {
  const double truth = std::sqrt(0.91 + 0.09 * 100.0), ratio = mean_ratio(0.3, 100);
  EXPECT_GT(ratio, 0.75 * truth) << "blocks of 5 s alone would state 0.37 of it";
  EXPECT_LT(ratio, 1.1 * truth);
}

TEST(ClusterRobust, recordings_share_no_block) {
  ClusterRobust robust(Eigen::MatrixXd::Identity(1, 1));
  for (int k = 0; k < 40; ++k) {
    robust.add(0.0, Eigen::VectorXd::Constant(1, k % 2 == 0 ? 1.0 : -1.0));
    robust.end_recording();
  }
  EXPECT_NEAR(robust.inflated(1.0)(0, 0), 40.0 * 40.0 / 39.0, 1e-9);
}

TEST(ClusterRobust, nothing_measured_leaves_the_model) {
  EXPECT_EQ(ClusterRobust(Eigen::MatrixXd::Identity(2, 2)).inflated(1.0), Eigen::MatrixXd::Identity(2, 2));
}

}  // namespace
}  // namespace odomcalib::calib::math::cluster_robust_test
