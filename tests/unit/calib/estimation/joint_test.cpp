#include "calib/estimation/joint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "calib/terms/catalogue.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/estimation/driven_wheels.hpp"

namespace odomcalib::calib::estimation::joint_test {
namespace {

constexpr unsigned kSeed = 3;

struct Fixture {
  explicit Fixture(double noise, unsigned seed = kSeed, double delay = 0.0, double outlier_share = 0.0)
      : model(drive(200.0), vehicle::make_context(drive(200.0), kNominal)) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<vehicle::Interval> shifted;
    for (double t = 1.0; t < 198.0; t += 0.5) shifted.push_back({t - delay, t + 0.5 - delay});
    const Eigen::VectorXd truth = vehicle::to_vector(kTruth);
    const auto motions = model.predict({truth.data(), 6}, {}, shifted);
    for (std::size_t k = 0; k < motions.size(); ++k) {
      measurement::SensorPair pair;
      pair.interval = {shifted[k].begin + delay, shifted[k].end + delay};
      pair.motion = motions[k];
      pair.motion.x += noise * gauss(engine);
      pair.motion.y += noise * gauss(engine);
      pair.motion.yaw += noise * gauss(engine);
      if (uniform(engine) < outlier_share) pair.motion.x += 0.1;
      pair.covariance = noise > 0.0 ? Eigen::Matrix3d(noise * noise * Eigen::Matrix3d::Identity())
                                    : Eigen::Matrix3d(1e-12 * Eigen::Matrix3d::Identity());
      pairs.push_back(pair);
    }
  }
  vehicle::DriveModel model;
  std::vector<measurement::SensorPair> pairs;
};

TEST(Joint, recovers_the_truth_from_noise_free_pairs) {
  Fixture f(0.0);
  const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
  const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal));
  ASSERT_TRUE(fit.ok()) << fit.error().text();
  EXPECT_LT((fit.value().parameters - vehicle::to_vector(kTruth)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Joint, ten_percent_gross_errors_move_the_answer_by_less_than_two_sigma) {
  Fixture f(1e-3, kSeed, 0.0, 0.1);
  const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
  const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal));
  ASSERT_TRUE(fit.ok());
  const Eigen::VectorXd error = fit.value().parameters - vehicle::to_vector(kTruth);
  for (Eigen::Index k = 0; k < 6; ++k)
    EXPECT_LT(std::abs(error(k)), 3.5 * std::sqrt(fit.value().covariance(k, k))) << "parameter " << k;
  EXPECT_GT(fit.value().discarded, f.pairs.size() / 20);
}

TEST(Joint, S1_13_SD_12_finds_a_delay_of_fifty_milliseconds_within_two) {
  Fixture f(1e-3, kSeed, 0.05);
  const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
  const vehicle::EffectList effects = {terms::find_effect("time_offset")};
  const auto fit = fit_joint(data, effects, vehicle::to_vector(kNominal, vehicle::count_parameters(effects)));
  ASSERT_TRUE(fit.ok());
  EXPECT_NEAR(fit.value().parameters(vehicle::kBaseCount), 0.05, 0.002);
}

// The published J is a log-likelihood, to be maximised; what is told here is a cost.
TEST(Joint, S3_06_the_cost_falls_from_iteration_to_iteration) {
  const Fixture f(1e-3);
  const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
  const auto settled = fit_joint(data, {}, vehicle::to_vector(kNominal));
  ASSERT_TRUE(settled.ok());
  FitOptions options;
  options.noise = settled.value().noise;
  double before = std::numeric_limits<double>::infinity();
  for (options.max_iterations = 3; options.max_iterations <= 24; options.max_iterations += 3) {
    const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal), options);
    ASSERT_TRUE(fit.ok());
    EXPECT_LE(fit.value().cost, before + 1e-9 * std::abs(before)) << options.max_iterations;
    before = fit.value().cost;
  }
  EXPECT_LE(settled.value().cost, before + 1e-6 * std::abs(before));
}

TEST(Joint, reported_deviations_agree_with_the_scatter) {
  constexpr unsigned kRuns = 40;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(6);
  Eigen::VectorXd reported = Eigen::VectorXd::Zero(6);
  for (unsigned run = 0; run < kRuns; ++run) {
    Fixture f(1e-3, 100 + run);
    const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
    const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal));
    ASSERT_TRUE(fit.ok());
    squares += (fit.value().parameters - vehicle::to_vector(kTruth)).cwiseAbs2();
    reported += fit.value().covariance.diagonal();
  }
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double ratio = std::sqrt(reported(k) / squares(k));
    EXPECT_GT(ratio, 0.7) << "parameter " << k;
    EXPECT_LT(ratio, 1.5) << "parameter " << k;
  }
}

/// Drives of one robot with so many pairs each, whose errors are so large, m and rad; all are stated to be
/// half a millimetre.
struct SeveralDrives {
  SeveralDrives(std::size_t pairs, const std::vector<double>& errors) {
    for (const double error : errors) {
      fixtures.push_back(std::make_unique<Fixture>(error, kSeed + static_cast<unsigned>(fixtures.size())));
      Fixture& one = *fixtures.back();
      one.pairs.resize(pairs);
      for (measurement::SensorPair& pair : one.pairs) pair.covariance = 2.5e-7 * Eigen::Matrix3d::Identity();
      data.push_back({&one.model, one.pairs});
    }
  }
  /// m, standard deviation that the fit found in each.
  [[nodiscard]] std::vector<double> found() const {
    const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal));
    EXPECT_TRUE(fit.ok());
    std::vector<double> deviations;
    for (const measurement::NoiseModel& noise : fit.value().noise)
      deviations.push_back(std::hypot(5e-4 * noise.matcher_scale, noise.process_translation));
    return deviations;
  }
  std::vector<std::unique_ptr<Fixture>> fixtures;
  std::vector<measurement::FitData> data;
};

TEST(Joint, drives_of_few_pairs_share_the_noise_that_all_of_them_show) {
  const auto found = SeveralDrives(60, {1e-3, 1e-3}).found();
  EXPECT_EQ(found[0], found[1]);
  EXPECT_NEAR(found[0], 1e-3, 1.5e-4);
}

TEST(Joint, a_drive_of_a_hundred_pairs_has_a_noise_of_its_own) {
  const auto own = SeveralDrives(100, {1e-3, 3e-3}).found();
  EXPECT_NEAR(own[0], 1e-3, 2e-4);
  EXPECT_NEAR(own[1], 3e-3, 6e-4);
  const auto common = SeveralDrives(99, {1e-3, 3e-3}).found();
  EXPECT_EQ(common[0], common[1]);
  EXPECT_GT(common[0], 1.3e-3);
  EXPECT_LT(common[0], 3e-3);
}

TEST(Joint, straight_motion_alone_is_refused_and_names_what_is_missing) {
  wheels::WheelTrack track;
  for (int k = 0; k <= 1000; ++k) {
    track.t.push_back(0.02 * k);
    track.left.push_back(0.1 * k);
    track.right.push_back(0.1 * k);
    track.segment.push_back(0);
  }
  const vehicle::DriveModel model(track, vehicle::make_context(track, kNominal));
  measurement::FitData data{&model, {}};
  for (double t = 0.5; t < 19.0; t += 0.5) {
    measurement::SensorPair pair;
    pair.interval = {t, t + 0.5};
    pair.motion = {0.1875, 0.0, 0.0};
    pair.covariance = 1e-6 * Eigen::Matrix3d::Identity();
    data.pairs.push_back(pair);
  }
  const std::vector<measurement::FitData> all = {data};
  const auto fit = fit_joint(all, {}, vehicle::to_vector(kNominal));
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.error().code, ErrorCode::refused);
  EXPECT_NE(fit.error().what.find("does not determine"), std::string::npos);
  EXPECT_EQ(fit.error().remedy, "record turns on the spot, both ways");
}

TEST(Joint, parameters_that_are_too_few_are_refused) {
  const Fixture f(1e-3, kSeed);
  const std::vector<measurement::FitData> data = {{&f.model, f.pairs}};
  const vehicle::EffectList effects = {terms::find_effect("time_offset")};
  EXPECT_NO_THROW(
      (void)fit_joint(data, effects, vehicle::to_vector(kNominal, vehicle::count_parameters(effects))));
  EXPECT_THROW((void)fit_joint(data, effects, vehicle::to_vector(kNominal)), std::invalid_argument);
}

TEST(Joint, no_pairs_is_an_error_of_its_own) {
  Fixture f(1e-3);
  const std::vector<measurement::FitData> data = {{&f.model, {}}};
  const auto fit = fit_joint(data, {}, vehicle::to_vector(kNominal));
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.error().code, ErrorCode::empty);
}

}  // namespace
}  // namespace odomcalib::calib::estimation::joint_test
