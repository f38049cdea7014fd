#include "calib/measurement/noise_estimate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace odomcalib::calib::measurement::noise_test {
namespace {

constexpr unsigned kSeed = 11;

struct Chain {
  std::vector<SensorPair> pairs;
  std::vector<PairState> states;
  std::vector<Eigen::Vector3d> residuals;
};

/// Errors made the way they arise: one error per scan entering two pairs, one per pair, one stamp error per
/// scan.
Chain make_chain(std::size_t count, double scan_sigma, double pair_sigma, double jitter) {
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&](double sigma) {
    return Eigen::Vector3d(sigma * gauss(engine), sigma * gauss(engine), sigma * gauss(engine));
  };
  Chain chain;
  Eigen::Vector3d scan = vector(scan_sigma);
  Eigen::Vector3d velocity(uniform(engine), uniform(engine), uniform(engine));
  double stamp = jitter * gauss(engine);
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d next_scan = vector(scan_sigma);
    const Eigen::Vector3d next_velocity(uniform(engine), uniform(engine), uniform(engine));
    const double next_stamp = jitter * gauss(engine);
    SensorPair pair;
    pair.covariance = 2.0 * scan_sigma * scan_sigma * Eigen::Matrix3d::Identity();
    pair.follows_previous = k > 0;
    PairState state;
    state.begin_velocity = velocity;
    state.end_velocity = next_velocity;
    chain.residuals.emplace_back(next_scan - scan + vector(pair_sigma) + next_stamp * next_velocity -
                                 stamp * velocity);
    chain.pairs.push_back(pair);
    chain.states.push_back(state);
    scan = next_scan;
    velocity = next_velocity;
    stamp = next_stamp;
  }
  return chain;
}

TEST(Noise, tells_time_stamps_from_wheels) {
  const Chain chain = make_chain(3000, 1e-3, 2e-3, 0.015);
  const NoiseModel noise = estimate_noise(chain.pairs, chain.states, chain.residuals, {});
  EXPECT_NEAR(noise.stamp_jitter, 0.015, 0.004);
  const Chain nuisance = make_chain(3000, 1e-3, 2e-3, 0.0);
  EXPECT_LT(estimate_noise(nuisance.pairs, nuisance.states, nuisance.residuals, {}).stamp_jitter, 0.002);
}

/// More than are judged.
TEST(Noise, of_very_many_pairs_is_that_of_fewer) {
  const Chain chain = make_chain(3 * settings::kMostNoisePairs + 1, 1e-3, 2e-3, 0.015);
  const NoiseModel noise = estimate_noise(chain.pairs, chain.states, chain.residuals, {});
  EXPECT_NEAR(noise.stamp_jitter, 0.015, 0.0015) << "seed " << kSeed;
  const double matcher = noise.matcher_scale * noise.matcher_scale * 2e-6;
  EXPECT_NEAR(matcher + noise.process_translation * noise.process_translation, 6e-6, 6e-7)
      << "seed " << kSeed;
}

TEST(Noise, scans_shared_by_neighbours_give_negative_correlation) {
  const Chain shared = make_chain(3000, 2e-3, 0.0, 0.0);
  for (const double c : estimate_noise(shared.pairs, shared.states, shared.residuals, {}).correlation)
    EXPECT_NEAR(c, -0.47, 0.06);
  const Chain independent = make_chain(3000, 1e-6, 2e-3, 0.0);
  for (const double c :
       estimate_noise(independent.pairs, independent.states, independent.residuals, {}).correlation)
    EXPECT_NEAR(c, 0.0, 0.06);
}

TEST(Whitener, makes_residuals_uncorrelated_with_unit_variance) {
  const Chain chain = make_chain(4000, 1e-3, 1e-3, 0.0);
  const NoiseModel noise = estimate_noise(chain.pairs, chain.states, chain.residuals, {});
  const std::vector<double> ones(chain.pairs.size(), 1.0);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * chain.pairs.size()), 1);
  for (std::size_t k = 0; k < chain.pairs.size(); ++k)
    rows.block<3, 1>(static_cast<Eigen::Index>(3 * k), 0) = chain.residuals[k];
  Whitener(chain.pairs, chain.states, noise, ones).apply(rows);
  const double n = static_cast<double>(chain.pairs.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double square = 0.0;
    double lagged = 0.0;
    for (Eigen::Index k = axis; k < rows.rows(); k += 3) {
      square += rows(k, 0) * rows(k, 0);
      if (k > 3) lagged += rows(k, 0) * rows(k - 3, 0);
    }
    // The t likelihood with four degrees of freedom reads Gaussian noise as a slightly narrower core.
    EXPECT_NEAR(square / n, 1.0, 0.25);
    EXPECT_NEAR(lagged / square, 0.0, 0.06);
  }
}

TEST(Whitener, equals_the_dense_inverse_root) {
  const Chain chain = make_chain(6, 1e-3, 1e-3, 0.01);
  NoiseModel noise;
  noise.process_translation = 1e-3;
  noise.process_rotation = 1e-3;
  noise.stamp_jitter = 0.01;
  noise.correlation = {-0.4, -0.2, 0.1};
  const std::vector<double> ones(chain.pairs.size(), 1.0);
  Eigen::MatrixXd inverse_root = Eigen::MatrixXd::Identity(18, 18);
  Whitener(chain.pairs, chain.states, noise, ones).apply(inverse_root);
  const Eigen::MatrixXd covariance = (inverse_root.transpose() * inverse_root).inverse();
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::Matrix3d block =
        covariance.block<3, 3>(static_cast<Eigen::Index>(3 * k), static_cast<Eigen::Index>(3 * k));
    EXPECT_LT((block - full_covariance(chain.pairs[k], chain.states[k], noise)).cwiseAbs().maxCoeff(), 1e-12);
  }
  EXPECT_LT((covariance.block<3, 3>(0, 6)).cwiseAbs().maxCoeff(), 1e-12) << "only neighbours are correlated";
  EXPECT_GT((covariance.block<3, 3>(0, 3)).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace odomcalib::calib::measurement::noise_test
