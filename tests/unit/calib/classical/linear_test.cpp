#include "calib/classical/linear.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <limits>
#include <random>

#include "calib/classical/closed_form.hpp"
#include "calib/classical/settings.hpp"
#include "proto/recording/recording.hpp"
#include "tests/unit/calib/shared_data.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::calib::classical::linear_test {
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
  const auto result = value_of(solve_linear(generic_pairs(some_matrix(), 1000)));
  EXPECT_LT((result.matrix - some_matrix()).norm(), 1e-9);
  EXPECT_LE(result.orthogonality, 1e-10);
}

TEST(Linear, S0_05_S0_15_three_generic_samples_are_exact_and_two_are_refused) {
  const auto exact = value_of(solve_linear(generic_pairs(some_matrix(), 3)));
  EXPECT_LT((exact.matrix - some_matrix()).norm(), 1e-9);
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

/// Pairs of a robot that drives arcs with little sideways motion, as real ones do, and a noisy reference.
std::vector<IncrementPair> driven_pairs(std::size_t count, double noise, double curvature) {
  std::mt19937 engine(17);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> gauss(0.0, noise);
  std::vector<IncrementPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const math::Pose u = math::exp_se2(0.2 * uniform(engine), 0.0, curvature * uniform(engine));
    const Eigen::Vector3d seen = some_matrix() * Eigen::Vector3d(u.x, u.y, u.yaw);
    pairs.push_back({u, {seen(0) + gauss(engine), seen(1) + gauss(engine), seen(2) + gauss(engine)}});
  }
  return pairs;
}

constexpr std::array kSolvers = {LinearSolver::qr, LinearSolver::svd, LinearSolver::ldlt,
                                 LinearSolver::normal_equations};

TEST(Linear, S0_06_S0_16_four_solvers_agree_where_the_condition_allows_and_say_which_was_used) {
  const auto pairs = generic_pairs(some_matrix(), 500);
  const auto reference = solve_linear(pairs).value();
  ASSERT_LT(reference.condition, 1e6) << "of A^T A: the square of that of A";
  for (const LinearSolver solver : kSolvers) {
    const auto result = value_of(solve_linear(pairs, solver));
    EXPECT_EQ(result.solver, solver);
    EXPECT_LT((result.matrix - reference.matrix).norm(), 1e-8) << name_of(solver);
  }
  const auto poor = driven_pairs(500, 0.0, 1e-3);
  for (const LinearSolver solver : kSolvers) {
    const auto result = value_of(solve_linear(poor, solver));
    ASSERT_GT(result.condition, settings::kMostConditionOfNormal);
    const bool exact = solver == LinearSolver::svd;
    EXPECT_EQ(result.solver, exact ? LinearSolver::svd : LinearSolver::qr) << name_of(solver);
  }
}

TEST(Linear, S0_07_S1_12_what_is_left_is_orthogonal_to_the_columns) {
  const auto result = value_of(solve_linear(driven_pairs(1000, 1e-3, 0.5)));
  EXPECT_GT(result.rms.minCoeff(), 5e-4) << "there is something left";
  EXPECT_LE(result.orthogonality, 1e-10);
}

TEST(Linear, S0_09_only_increments_of_the_base_obey_a_matrix) {
  const math::Pose mount{0.3, 0.1, 20.0 * math::kPi / 180.0};
  constexpr double kNoise = 1e-3;
  auto base = driven_pairs(2000, kNoise, 0.5);
  auto of_lidar = base;
  for (IncrementPair& pair : of_lidar) pair.observed = conjugate(pair.observed, mount);
  const auto transformed = solve_linear(base).value();
  EXPECT_LT(transformed.rms.maxCoeff(), 1.1 * kNoise);
  const auto untransformed = solve_linear(of_lidar).value();
  EXPECT_GT(untransformed.rms.head<2>().maxCoeff(), 5.0 * kNoise);
}

TEST(Linear, S0_10_S1_11_the_blocks_are_Kronecker_products_and_the_equations_scalar_ones) {
  const auto pairs = driven_pairs(200, 1e-3, 0.5);
  Eigen::MatrixXd stacked(600, 9);
  Eigen::VectorXd observed(600);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::RowVector3d u(pairs[i].odometry.x, pairs[i].odometry.y, pairs[i].odometry.yaw);
    Eigen::Matrix<double, 3, 9> block = Eigen::Matrix<double, 3, 9>::Zero();  // kron(I3, u^T)
    for (Eigen::Index k = 0; k < 3; ++k) block.block<1, 3>(k, 3 * k) = u;
    const auto row = static_cast<Eigen::Index>(3 * i);
    stacked.middleRows<3>(row) = block;
    observed.segment<3>(row) << pairs[i].observed.x, pairs[i].observed.y, pairs[i].observed.yaw;
  }
  const Eigen::Matrix<double, 9, 1> x = stacked.householderQr().solve(observed);
  const Eigen::Matrix3d reshaped = x.reshaped<Eigen::RowMajor>(3, 3);
  const auto result = solve_linear(pairs).value();
  EXPECT_LT((result.matrix - reshaped).norm(), 1e-9);
  const math::Pose u = pairs[7].odometry;
  const math::Pose v = corrected(result.matrix, u);
  EXPECT_NEAR(v.x, x(0) * u.x + x(1) * u.y + x(2) * u.yaw, 1e-12);
  EXPECT_NEAR(v.y, x(3) * u.x + x(4) * u.y + x(5) * u.yaw, 1e-12);
  EXPECT_NEAR(v.yaw, x(6) * u.x + x(7) * u.y + x(8) * u.yaw, 1e-12);
}

TEST(LinearSums, S0_11_a_stream_gives_what_the_whole_gives) {
  const auto pairs = driven_pairs(100000, 1e-3, 0.5);
  LinearSums sums;
  for (const IncrementPair& pair : pairs) ASSERT_FALSE(sums.add(pair));
  const auto streamed = value_of(sums.solve());
  const auto batch = solve_linear(pairs).value();
  EXPECT_LT((streamed.matrix - batch.matrix).norm(), 1e-9 * batch.matrix.norm());
  EXPECT_LT((streamed.rms - batch.rms).norm(), 1e-6 * batch.rms.norm());
  EXPECT_EQ(streamed.used, batch.used);
}

TEST(LinearSums, S0_14_a_million_samples_fit_and_what_is_no_number_is_turned_away_by_name) {
  LinearSums sums;
  const auto pairs = generic_pairs(some_matrix(), 1000);
  for (int k = 0; k < 1000; ++k)
    for (const IncrementPair& pair : pairs) ASSERT_FALSE(sums.add(pair));
  IncrementPair broken = pairs[0];
  broken.odometry.y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(sums.add(broken), "the odometry's increment is not finite");
  broken = pairs[0];
  broken.observed.yaw = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sums.add(broken), "the observed increment is not finite");
  EXPECT_EQ(sums.count(), 1000000U);
  EXPECT_LT((sums.solve().value().matrix - some_matrix()).norm(), 1e-8);
  EXPECT_FALSE(LinearSums{}.solve().ok()) << "nothing was added";
}

TEST(Linear, S0_12_the_corrected_increments_make_the_path_of_the_scans) {
  const auto pairs = driven_pairs(1000, 0.0, 0.5);  // 100 m
  const auto result = solve_linear(pairs).value();
  std::vector<math::Pose> fixed, seen;
  for (const IncrementPair& pair : pairs) {
    fixed.push_back(corrected(result.matrix, pair.odometry));
    seen.push_back(pair.observed);
  }
  const auto ours = path_of(fixed), theirs = path_of(seen);
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t k = 0; k < ours.size(); ++k)
    EXPECT_LT(std::hypot(ours[k].x - theirs[k].x, ours[k].y - theirs[k].y), 1e-6);
}

TEST(Linear, S0_24_reverse_and_clockwise_motion_counts) {
  // All forward and to the left, then the same motions with both signs: the same matrix from either.
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(0.05, 0.2);
  std::vector<IncrementPair> there, both;
  for (int k = 0; k < 300; ++k) {
    const math::Pose u = math::exp_se2(uniform(engine), 0.0, 3.0 * uniform(engine));
    const math::Pose back = math::exp_se2(-uniform(engine), 0.0, -3.0 * uniform(engine));
    there.push_back({u, corrected(some_matrix(), u)});
    both.push_back(there.back());
    both.push_back({back, corrected(some_matrix(), back)});
  }
  EXPECT_LT((solve_linear(there).value().matrix - some_matrix()).norm(), 1e-6);
  EXPECT_LT((solve_linear(both).value().matrix - some_matrix()).norm(), 1e-6);
  EXPECT_EQ(solve_linear(both).value().used, both.size()) << "none is dropped for its sign";
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
  const auto recording = value_of(
      read_recording(odomcalib::test_support::shared_data("khepera-censi") / expected.file, &unknown));
  std::vector<wheels::WheelMotion> samples;
  for (const IncrementSample& s : recording.increments)
    samples.push_back({s.duration * s.left_speed,
                       s.duration * s.right_speed,
                       {s.lidar_motion[0], s.lidar_motion[1], s.lidar_motion[2]}});
  const auto closed = value_of(solve_closed_form(samples));
  std::vector<IncrementPair> pairs;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!expected.inliers || std::binary_search(closed.inliers.begin(), closed.inliers.end(), i))
      pairs.push_back({wheels::wheel_arc(0.0205 * samples[i].left, 0.0205 * samples[i].right, 0.08841),
                       samples[i].sensor_motion});
  const auto result = value_of(solve_linear(pairs));
  Eigen::Matrix3d x;
  x << expected.x11, expected.x12, expected.x13, expected.x21, expected.x22, expected.x23, expected.x31,
      expected.x32, expected.x33;
  EXPECT_LE((result.matrix - x).cwiseAbs().maxCoeff(), expected.digits) << result.matrix;
  EXPECT_NEAR(result.condition / expected.condition, 1.0, 0.01);
  if (std::string(expected.file) == "lstraight.tuple" && expected.inliers) {
    const LinearReading reading = read_linear(result.matrix, 0.0205, 0.08841);
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
}  // namespace odomcalib::calib::classical::linear_test
