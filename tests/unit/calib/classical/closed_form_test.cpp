#include "calib/classical/closed_form.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "proto/recording/recording.hpp"
#include "tests/unit/calib/shared_data.hpp"
#include "tests/unit/calib/synthetic.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::calib::classical::closed_form_test {
namespace {

using odomcalib::test_support::random_motions;
using odomcalib::test_support::shared_data;

constexpr unsigned kSeed = 1;
const wheels::BaseParameters kTruth{0.0752, 0.0748, 0.405, {0.11, -0.02, 0.4}};

void expect_parameters(const wheels::BaseParameters& a, const wheels::BaseParameters& b, double tolerance) {
  EXPECT_NEAR(a.left_radius, b.left_radius, tolerance);
  EXPECT_NEAR(a.right_radius, b.right_radius, tolerance);
  EXPECT_NEAR(a.track_width, b.track_width, tolerance);
  EXPECT_NEAR(a.mount.x, b.mount.x, tolerance);
  EXPECT_NEAR(a.mount.y, b.mount.y, tolerance);
  EXPECT_NEAR(math::wrap_angle(a.mount.yaw - b.mount.yaw), 0.0, tolerance);
}

TEST(ClosedForm, S3_09_recovers_the_truth_from_noise_free_motions_with_a_positive_track) {
  const auto result = value_of(solve_closed_form(random_motions(kTruth, 200, kSeed), {0, 0.01}));
  expect_parameters(result.parameters, kTruth, 1e-9);
  EXPECT_GT(result.parameters.track_width, 0.0);
}

TEST(ClosedForm, S3_15_swapped_wheels_swap_the_named_parameters) {
  auto motions = random_motions(kTruth, 200, kSeed);
  for (wheels::WheelMotion& m : motions) {
    std::swap(m.left, m.right);
    m.sensor_motion.y = -m.sensor_motion.y;
    m.sensor_motion.yaw = -m.sensor_motion.yaw;
  }
  const auto result = value_of(solve_closed_form(motions, {0, 0.01}));
  EXPECT_NEAR(result.parameters.left_radius, kTruth.right_radius, 1e-9);
  EXPECT_NEAR(result.parameters.right_radius, kTruth.left_radius, 1e-9);
}

TEST(ClosedForm, SD_03_scaling_all_lengths_scales_the_answer) {
  // The eigenvector must be chosen by index, not by the size of its eigenvalue.
  auto motions = random_motions(kTruth, 200, kSeed);
  for (wheels::WheelMotion& m : motions) {
    m.sensor_motion.x *= 100.0;
    m.sensor_motion.y *= 100.0;
  }
  const auto result = value_of(solve_closed_form(motions, {0, 0.01}));
  EXPECT_NEAR(result.parameters.track_width, 100.0 * kTruth.track_width, 1e-6);
  EXPECT_NEAR(result.parameters.mount.yaw, kTruth.mount.yaw, 1e-9);
}

TEST(ClosedForm, S3_11_five_per_cent_of_slip_change_the_answer_by_less_than_a_sigma) {
  auto motions = random_motions(kTruth, 1000, kSeed, 1e-3, 2e-3);
  const auto clean = solve_closed_form(motions, {4, 0.02});
  for (std::size_t i = 0; i < motions.size(); i += 20) motions[i].left *= 1.5;
  const auto slipped = solve_closed_form(motions, {4, 0.02});
  ASSERT_TRUE(clean.ok() && slipped.ok());
  const double change = slipped.value().parameters.left_radius - clean.value().parameters.left_radius;
  EXPECT_LT(std::abs(change), std::sqrt(clean.value().covariance(0, 0)));
}

TEST(ClosedForm, S3_13_predicted_deviations_agree_with_the_scatter) {
  constexpr int kRuns = 200;
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> predicted = Eigen::Matrix<double, 6, 1>::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const auto result = value_of(solve_closed_form(
        random_motions(kTruth, 300, kSeed + static_cast<unsigned>(run), 1e-3, 2e-3), {0, 0.01}));
    const wheels::BaseParameters& p = result.parameters;
    Eigen::Matrix<double, 6, 1> error;
    error << p.left_radius - kTruth.left_radius, p.right_radius - kTruth.right_radius,
        p.track_width - kTruth.track_width, p.mount.x - kTruth.mount.x, p.mount.y - kTruth.mount.y,
        p.mount.yaw - kTruth.mount.yaw;
    squares += error.cwiseAbs2();
    predicted += result.covariance.diagonal();
  }
  // The closed form is unweighted in x, y, so that it may scatter a little more than the bound.
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(std::sqrt(squares(k) / predicted(k)), 1.0, 0.2) << "parameter " << k;
}

/// Wheels that always turn in one proportion: 1 straight, -1 on the spot.
std::vector<wheels::WheelMotion> one_motion(double proportion, double yaw_noise) {
  auto motions = random_motions(kTruth, 100, kSeed);
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> gauss(0.0, yaw_noise);
  for (wheels::WheelMotion& m : motions) {
    m.right = proportion * m.left * kTruth.left_radius / kTruth.right_radius;
    m.sensor_motion = odomcalib::test_support::sensor_motion_by_hand(kTruth, m.left, m.right);
    m.sensor_motion.yaw += gauss(engine);
  }
  return motions;
}

TEST(ClosedForm, SD_08_refuses_straight_lines_alone_and_spins_alone) {
  for (const double proportion : {1.0, -1.0})
    for (const double noise : {0.0, 1e-3}) {
      const auto result = solve_closed_form(one_motion(proportion, noise));
      ASSERT_FALSE(result.ok()) << proportion;
      EXPECT_EQ(result.error().code, ErrorCode::refused);
      EXPECT_NE(result.error().what.find("same proportion"), std::string::npos) << result.error().what;
    }
  EXPECT_EQ(solve_closed_form({}).error().code, ErrorCode::empty);
}

TEST(ClosedForm, S3_14_the_covariance_is_symmetric_and_positive_definite) {
  const auto result = value_of(solve_closed_form(random_motions(kTruth, 500, kSeed, 1e-3, 2e-3)));
  const auto& covariance = result.covariance;
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-12 * covariance.norm());
  EXPECT_GT((Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(covariance).eigenvalues().minCoeff()),
            0.0);
}

TEST(ClosedForm, SD_10_noise_is_that_of_the_inliers_and_both_are_told) {
  auto motions = random_motions(kTruth, 1000, kSeed, 1e-3, 2e-3);
  for (std::size_t i = 0; i < motions.size(); i += 50) motions[i].sensor_motion.x += 0.1;
  const auto result = value_of(solve_closed_form(motions));
  EXPECT_GT(result.first_rms(0), 5e-3) << "outliers are in it";
  EXPECT_LT(result.rms(0), 1.5e-3);
  const auto clean = solve_closed_form(random_motions(kTruth, 1000, kSeed, 1e-3, 2e-3));
  EXPECT_NEAR(std::sqrt(result.covariance(0, 0) / clean.value().covariance(0, 0)), 1.0, 0.15);
}

TEST(ClosedForm, S3_12_each_round_cuts_its_share_by_position_and_by_heading) {
  const auto motions = random_motions(kTruth, 1000, kSeed, 1e-3, 2e-3);
  const std::size_t none = solve_closed_form(motions, {0, 0.01}).value().inliers.size();
  const std::size_t once = solve_closed_form(motions, {1, 0.02}).value().inliers.size();
  EXPECT_EQ(none, 1000U);
  // Two rounds of cutting, each 2 % by either error; some samples are bad by both.
  EXPECT_LE(once, 1000U - 35U);
  EXPECT_GE(once, 1000U - 80U);
}

TEST(ClosedForm, S3_05_the_laser_moves_as_the_conjugate_of_the_base) {
  for (const wheels::WheelMotion& m : random_motions(kTruth, 1000, kSeed)) {
    const math::Pose moved = conjugate(
        wheels::wheel_arc(kTruth.left_radius * m.left, kTruth.right_radius * m.right, kTruth.track_width),
        kTruth.mount);
    EXPECT_NEAR(moved.x, m.sensor_motion.x, 1e-12);
    EXPECT_NEAR(moved.y, m.sensor_motion.y, 1e-12);
    EXPECT_NEAR(moved.yaw, m.sensor_motion.yaw, 1e-12);
  }
}

TEST(ClosedForm, SD_13_a_drive_backwards_calibrates_as_one_forwards) {
  auto motions = random_motions(kTruth, 200, kSeed);
  for (wheels::WheelMotion& m : motions) {
    m.left = -std::abs(m.left);
    m.right = -std::abs(m.right);
    m.sensor_motion = odomcalib::test_support::sensor_motion_by_hand(kTruth, m.left, m.right);
  }
  const auto result = value_of(solve_closed_form(motions, {0, 0.01}));
  expect_parameters(result.parameters, kTruth, 1e-9);
}

TEST(ClosedForm, SD_07_the_first_and_the_last_sample_count) {
  auto motions = random_motions(kTruth, 100, kSeed);
  const auto whole = solve_closed_form(motions, {0, 0.01}).value().parameters;
  for (const std::size_t k : {std::size_t{0}, motions.size() - 1}) {
    auto changed = motions;
    changed[k].sensor_motion.yaw += 0.01;
    EXPECT_NE(solve_closed_form(changed, {0, 0.01}).value().parameters.left_radius, whole.left_radius) << k;
  }
}

struct Published {
  const char* file;
  double left_diameter, right_diameter, track_width, x, y, yaw;
  std::size_t kept;
};

class CensiTuples : public ::testing::TestWithParam<Published> {};

// Censi et al., T-RO 2013; reference output of the authors, six digits.
TEST_P(CensiTuples, S1_15_S3_08_S3_09_give_the_published_values) {
  const Published& expected = GetParam();
  ODOMCALIB_NEEDS_SHARED("khepera-censi");
  RobotDescription unknown;
  const auto recording = value_of(read_recording(shared_data("khepera-censi") / expected.file, &unknown));
  std::vector<wheels::WheelMotion> samples;
  for (const IncrementSample& s : recording.increments)
    samples.push_back({s.duration * s.left_speed,
                       s.duration * s.right_speed,
                       {s.lidar_motion[0], s.lidar_motion[1], s.lidar_motion[2]}});
  const auto result = value_of(solve_closed_form(samples));
  const wheels::BaseParameters& p = result.parameters;
  constexpr double kRelative = 1e-5;
  EXPECT_NEAR(2.0 * p.left_radius / expected.left_diameter, 1.0, kRelative);
  EXPECT_NEAR(2.0 * p.right_radius / expected.right_diameter, 1.0, kRelative);
  EXPECT_NEAR(p.track_width / expected.track_width, 1.0, kRelative);
  EXPECT_NEAR(p.mount.x / expected.x, 1.0, kRelative);
  EXPECT_NEAR(p.mount.y / expected.y, 1.0, kRelative);
  EXPECT_NEAR(p.mount.yaw / expected.yaw, 1.0, kRelative);
  EXPECT_EQ(result.inliers.size(), expected.kept);
}

INSTANTIATE_TEST_SUITE_P(
    Khepera, CensiTuples,
    ::testing::Values(Published{"lstraight.tuple", 0.0417709, 0.0418957, 0.0890519, -0.00581279, 0.000185606,
                                0.00949588, 4008},
                      Published{"l90.tuple", 0.0411796, 0.0414408, 0.0880134, -0.00262327, 0.00584952,
                                -1.55772, 3035}),
    [](const auto& tested) {
      return std::string(tested.param.file).substr(0, std::string(tested.param.file).find('.'));
    });

}  // namespace
}  // namespace odomcalib::calib::classical::closed_form_test
