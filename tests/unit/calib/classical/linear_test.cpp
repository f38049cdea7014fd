#include "calib/classical/linear.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "calib/classical/closed_form.hpp"
#include "proto/recording/recording.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::calib::classical {
namespace {

std::vector<IncrementPair> generic_pairs(const Eigen::Matrix3d& x, std::size_t count) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<IncrementPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d u(uniform(engine), uniform(engine), uniform(engine));
    const Eigen::Vector3d seen = x * u;
    pairs.push_back({{u(0), u(1), u(2)}, {seen(0), seen(1), seen(2)}});
  }
  return pairs;
}

Eigen::Matrix3d some_matrix() {
  Eigen::Matrix3d x;
  x << 1.02, -0.01, 0.003, 0.02, 0.98, -0.004, 0.01, 0.05, 1.03;
  return x;
}

TEST(Linear, S0_01_recovers_the_matrix_from_noise_free_data) {
  const auto result = solve_linear(generic_pairs(some_matrix(), 1000));
  ASSERT_TRUE(result.ok());
  EXPECT_LT((result.value().matrix - some_matrix()).norm(), 1e-9);
  EXPECT_LE(result.value().orthogonality, 1e-10);
}

TEST(Linear, S0_05_S0_15_three_generic_samples_are_exact_and_two_are_refused) {
  const auto exact = solve_linear(generic_pairs(some_matrix(), 3));
  ASSERT_TRUE(exact.ok());
  EXPECT_LT((exact.value().matrix - some_matrix()).norm(), 1e-9);
  const auto refused = solve_linear(generic_pairs(some_matrix(), 2));
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().what.find("underdetermined"), std::string::npos);
}

TEST(Linear, S0_05_straight_lines_alone_are_refused_and_name_what_is_missing) {
  std::vector<IncrementPair> pairs(1000);
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].odometry.x = pairs[i].observed.x = 0.1;
  const auto result = solve_linear(pairs);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().what.find("rotation"), std::string::npos);
}

TEST(Linear, S0_14_refuses_values_that_are_not_finite) {
  auto pairs = generic_pairs(some_matrix(), 10);
  pairs[3].observed.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_linear(pairs).ok());
}

struct Printed {
  const char* file;
  bool inliers;
  double x11, x12, x13, x21, x22, x23, x31, x32, x33;
  double condition;
  double digits;  ///< half a unit of the last printed digit
};

class LinearOnCensiTuples : public ::testing::TestWithParam<Printed> {};

// Reference values computed independently on the same tuples with nominal radius 20.5 mm and track
// width 88.41 mm.
TEST_P(LinearOnCensiTuples, S1_08_agrees_to_the_printed_digits) {
  const Printed& expected = GetParam();
  ODOMCALIB_NEEDS_SHARED("khepera-censi");
  RobotDescription unknown;
  const auto recording =
      read_recording(odomcalib::testing::shared_data("khepera-censi") / expected.file, &unknown);
  ASSERT_TRUE(recording.ok()) << recording.error().text();
  std::vector<wheels::WheelMotion> samples;
  for (const IncrementSample& s : recording.value().increments)
    samples.push_back({s.duration * s.left_speed,
                       s.duration * s.right_speed,
                       {s.lidar_motion[0], s.lidar_motion[1], s.lidar_motion[2]}});
  const auto closed = solve_closed_form(samples);
  ASSERT_TRUE(closed.ok());
  std::vector<IncrementPair> pairs;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!expected.inliers ||
        std::binary_search(closed.value().inliers.begin(), closed.value().inliers.end(), i))
      pairs.push_back({wheels::wheel_arc(0.0205 * samples[i].left, 0.0205 * samples[i].right, 0.08841),
                       samples[i].sensor_motion});
  const auto result = solve_linear(pairs);
  ASSERT_TRUE(result.ok());
  Eigen::Matrix3d x;
  x << expected.x11, expected.x12, expected.x13, expected.x21, expected.x22, expected.x23, expected.x31,
      expected.x32, expected.x33;
  EXPECT_LE((result.value().matrix - x).cwiseAbs().maxCoeff(), expected.digits) << result.value().matrix;
  EXPECT_NEAR(result.value().condition / expected.condition, 1.0, 0.01);
  if (std::string(expected.file) == "lstraight.tuple" && expected.inliers) {
    const LinearReading reading = read_linear(result.value().matrix, 0.0205, 0.08841);
    EXPECT_NEAR(reading.left_radius + reading.right_radius, 0.04184, 5e-6);
    EXPECT_NEAR(reading.track_width, 0.08906, 1e-5);  // printed from rounded elements
  }
}

INSTANTIATE_TEST_SUITE_P(Khepera, LinearOnCensiTuples,
                         ::testing::Values(Printed{"lstraight.tuple", true, 1.0204, -0.0789, -0.0002, -0.0099,
                                                   0.8801, -0.0059, 0.0328, 0.1484, 1.0130, 6.3e5, 5.1e-5},
                                           Printed{"lstraight.tuple", false, 1.0200, -0.0256, -0.0014,
                                                   -0.0109, 0.8248, -0.0058, 0.0344, 0.3505, 1.0106, 7.3e5,
                                                   5.1e-5},
                                           Printed{"l90.tuple", true, 0.0135, -0.8169, 0.0026, 1.0073,
                                                   -0.0038, -0.0058, 0.0733, -0.0682, 1.0121, 6.6e5, 5.1e-5},
                                           Printed{"l90.tuple", false, 0.085, -6.978, 0.0025, 1.0345, 1.560,
                                                   0.0018, 0.118, -10.92, 0.996, 7.3e5, 5.1e-3}));

}  // namespace
}  // namespace odomcalib::calib::classical
