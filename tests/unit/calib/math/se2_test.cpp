#include "calib/math/se2.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

namespace odomcalib::calib::math::se2_test {
namespace {

constexpr unsigned kSeed = 20130421;

class Se2 : public ::testing::Test {
 protected:
  Pose random_pose() { return {position_(engine_), position_(engine_), angle_(engine_)}; }
  static void expect_same(const Pose& a, const Pose& b, double tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(wrap_angle(a.yaw - b.yaw), 0.0, tolerance);
  }
  std::mt19937 engine_{kSeed};
  std::uniform_real_distribution<double> position_{-10.0, 10.0};
  std::uniform_real_distribution<double> angle_{-4.0, 4.0};
};

TEST_F(Se2, S3_03_composes_associatively) {
  for (int i = 0; i < 1000; ++i) {
    const Pose a = random_pose();
    const Pose b = random_pose();
    const Pose c = random_pose();
    expect_same(compose(compose(a, b), c), compose(a, compose(b, c)), 1e-12);
  }
}

/// Homogeneous matrix of a pose, and back: v2t and t2v of the literature.
Eigen::Matrix3d to_matrix(const Pose& p) {
  Eigen::Matrix3d m;
  m << std::cos(p.yaw), -std::sin(p.yaw), p.x, std::sin(p.yaw), std::cos(p.yaw), p.y, 0.0, 0.0, 1.0;
  return m;
}
Pose to_pose(const Eigen::Matrix3d& m) { return {m(0, 2), m(1, 2), std::atan2(m(1, 0), m(0, 0))}; }

TEST_F(Se2, S2_26_poses_and_homogeneous_matrices_say_the_same) {
  for (int i = 0; i < 1000; ++i) {
    const Pose a = random_pose(), b = random_pose();
    expect_same(to_pose(to_matrix(a)), a, 1e-12);
    expect_same(to_pose(to_matrix(a) * to_matrix(b)), compose(a, b), 1e-12);
    expect_same(to_pose(to_matrix(a).inverse()), inverse(a), 1e-12);
    expect_same(to_pose(to_matrix(a).inverse() * to_matrix(b)), between(a, b), 1e-12);
  }
}

TEST_F(Se2, S3_04_inverse_cancels_on_both_sides) {
  for (int i = 0; i < 1000; ++i) {
    const Pose a = random_pose();
    expect_same(compose(a, inverse(a)), Pose{}, 1e-12);
    expect_same(compose(inverse(a), a), Pose{}, 1e-12);
  }
}

TEST_F(Se2, S0_02_between_undoes_compose) {
  double worst = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    Pose a = random_pose();
    Pose b = random_pose();
    if (i % 3 == 0) a.yaw = i % 2 == 0 ? kPi : -kPi;
    if (i % 5 == 0) b.yaw = i % 2 == 0 ? -kPi : kPi;
    const Pose c = compose(a, between(a, b));
    worst = std::max({worst, std::abs(c.x - b.x), std::abs(c.y - b.y), std::abs(wrap_angle(c.yaw - b.yaw))});
  }
  EXPECT_LT(worst, 1e-12) << "seed " << kSeed;
}

TEST_F(Se2, S0_03_the_increment_is_in_the_frame_of_its_start) {
  const double rho = 0.7, d = 0.3;
  const Pose start{2.0, -1.0, 1.1};
  // On an arc to the left the end lies to the left of the start.
  const Pose end = compose(start, Pose{rho * std::sin(d), rho * (1.0 - std::cos(d)), d});
  const Pose ours = between(start, end);
  EXPECT_NEAR(ours.x, rho * std::sin(d), 1e-12);
  EXPECT_NEAR(ours.y, rho * (1.0 - std::cos(d)), 1e-12);
  // With the heading at the end, as one published program has it, y changes its sign.
  const double dx = end.x - start.x, dy = end.y - start.y;
  const double theirs = -std::sin(end.yaw) * dx + std::cos(end.yaw) * dy;
  EXPECT_NEAR(theirs, -rho * (1.0 - std::cos(d)), 1e-12);
  // With the heading in the middle there is no sideways motion at all.
  const double middle = start.yaw + d / 2.0;
  EXPECT_NEAR(-std::sin(middle) * dx + std::cos(middle) * dy, 0.0, 1e-12);
}

TEST_F(Se2, S0_17_increments_across_half_a_turn_stay_small) {
  const Pose before{0.0, 0.0, kPi - 0.01}, after{0.1, 0.0, -kPi + 0.01};
  EXPECT_NEAR(wrap_angle(between(before, after).yaw), 0.02, 1e-12);
  EXPECT_NEAR(wrap_angle(between(after, before).yaw), -0.02, 1e-12);
}

TEST_F(Se2, S3_02_conjugation_equals_the_three_motion_form) {
  for (int i = 0; i < 1000; ++i) {
    const Pose motion = random_pose();
    const Pose mount = random_pose();
    expect_same(conjugate(motion, mount), compose(inverse(mount), compose(motion, mount)), 1e-12);
  }
}

TEST_F(Se2, exp_of_a_wheel_arc_is_the_exact_arc) {
  // Radius rho, angle d: (rho sin d, rho (1 - cos d), d); the heading after the motion would flip the sign of
  // y.
  for (const double d : {-3.0, -0.5, -1e-9, 1e-7, 0.3, 2.9}) {
    const double rho = 0.7;
    expect_same(exp_se2(rho * d, 0.0, d), Pose{rho * std::sin(d), rho * (1.0 - std::cos(d)), d},
                1e-15 + 1e-9 * d * d);
  }
}

TEST_F(Se2, log_inverts_exp) {
  std::uniform_real_distribution<double> small(-3.0, 3.0);
  for (int i = 0; i < 1000; ++i) {
    const Pose w{position_(engine_), position_(engine_), small(engine_)};
    expect_same(log_se2(exp_se2(w.x, w.y, w.yaw)), w, 1e-9);
  }
}

TEST_F(Se2, wraps_into_the_half_open_interval) {
  EXPECT_DOUBLE_EQ(wrap_angle(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(7.0 * kPi + 0.1), -kPi + 0.1, 1e-12);
  EXPECT_NEAR(wrap_angle(-0.2), -0.2, 1e-15);
}

}  // namespace
}  // namespace odomcalib::calib::math::se2_test
