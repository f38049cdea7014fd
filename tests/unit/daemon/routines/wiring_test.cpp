// Every way to mix up the wires of two wheels and a lidar: a robot with these faults is nudged, and they must
// be named. The robot here is written independently: it turns real wheels and moves a real mount.
#include "daemon/routines/wiring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <set>

namespace odomcalib::routines::wiring_test {
namespace {

constexpr double kRadius = 0.075, kTrack = 0.4;
constexpr double kRadians = std::numbers::pi / 180.0;

using Names = std::set<std::string>;

/// Everything between the program and the world.
class Robot {
 public:
  explicit Robot(Names faults, double lidar_yaw = 0.0, double configured_yaw = 0.0)
      : faults_(std::move(faults)), mount_yaw_(lidar_yaw), configured_yaw_(configured_yaw) {
    if (has("lidar_yaw")) mount_yaw_ += 90.0 * kRadians;
  }

  Nudge nudge(unsigned seed, bool sighted = true) {
    random_.seed(seed);
    Nudge out{move(0.05, 0.05), move(-0.052, 0.052), kRadius, kTrack, configured_yaw_};
    if (!sighted) out.ahead.seen = out.left.seen = std::nullopt;
    return out;
  }

 private:
  [[nodiscard]] bool has(const std::string& name) const { return faults_.contains(name); }

  /// @param left, right m of rim that are asked for
  NudgeMove move(double left, double right) {
    NudgeMove out;
    out.commanded = {left / kRadius, right / kRadius};
    double real_left = left, real_right = right;
    if (has("sides_exchanged") || has("motors_exchanged")) std::swap(real_left, real_right);
    if (has("left_motor_inverted") || has("left_wheel_inverted")) real_left = -real_left;
    if (has("right_motor_inverted") || has("right_wheel_inverted")) real_right = -real_right;
    double count_left = real_left, count_right = real_right;
    if (has("left_counts_inverted") || has("left_wheel_inverted")) count_left = -count_left;
    if (has("right_counts_inverted") || has("right_wheel_inverted")) count_right = -count_right;
    if (has("sides_exchanged") || has("counts_exchanged")) std::swap(count_left, count_right);
    out.counted = {1.02 * count_left / kRadius, 0.97 * count_right / kRadius};
    out.seen = seen(real_left, real_right);
    return out;
  }

  /// The base rolls on a circle; the lidar sits ahead of the axle and to the right of the middle.
  Pose seen(double left, double right) {
    const double turn = (right - left) / kTrack, ahead = 0.5 * (left + right);
    const double chord = std::abs(turn) < 1e-9 ? ahead : ahead * std::sin(0.5 * turn) / (0.5 * turn);
    const double mount_x = 0.12, mount_y = -0.05;
    const double x =
        chord * std::cos(0.5 * turn) + std::cos(turn) * mount_x - std::sin(turn) * mount_y - mount_x;
    const double y =
        chord * std::sin(0.5 * turn) + std::sin(turn) * mount_x + std::cos(turn) * mount_y - mount_y;
    const double c = std::cos(mount_yaw_), s = std::sin(mount_yaw_);
    Pose pose{c * x + s * y, -s * x + c * y, turn};
    if (has("lidar_mirrored")) pose = {pose.x, -pose.y, -pose.yaw};
    std::normal_distribution<double> metres(0.0, 0.002), radians(0.0, 0.003);
    return {pose.x + metres(random_), pose.y + metres(random_), pose.yaw + radians(random_)};
  }

  Names faults_;
  double mount_yaw_, configured_yaw_;
  std::mt19937 random_;
};

Names names_of(const std::vector<WiringFault>& faults) {
  Names names;
  for (const WiringFault& fault : faults) names.insert(fault.name);
  return names;
}

bool explained(const Wiring& wiring, const Names& faults) {
  return std::any_of(wiring.explanations.begin(), wiring.explanations.end(),
                     [&](const auto& one) { return names_of(one) == faults; });
}

std::string text(const Wiring& wiring) {
  std::string out = wiring.why;
  for (const auto& one : wiring.explanations) {
    out += " [";
    for (const WiringFault& fault : one) out += " " + fault.name;
    out += " ]";
  }
  return out;
}

TEST(Wiring, of_a_robot_as_in_its_papers_is_good_wherever_the_lidar_is_turned_to) {
  for (const double yaw : {0.0, 30.0, 90.0, 137.0, 180.0, -90.0}) {
    const auto wiring = judge_wiring(Robot({}, yaw * kRadians, yaw * kRadians).nudge(1));
    EXPECT_EQ(wiring.outcome, Wiring::Outcome::good) << yaw << text(wiring);
    ASSERT_TRUE(wiring.lidar_yaw.has_value());
    EXPECT_NEAR(wrapped(*wiring.lidar_yaw - yaw * kRadians), 0.0, 0.15) << yaw;
  }
}

class OneFault : public ::testing::TestWithParam<const char*> {};

TEST_P(OneFault, is_named) {
  for (const double yaw : {0.0, 90.0, 180.0, -90.0, 20.0})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const auto wiring = judge_wiring(Robot({GetParam()}, yaw * kRadians, yaw * kRadians).nudge(seed));
      ASSERT_EQ(wiring.outcome, Wiring::Outcome::wrong) << yaw << " seed " << seed << text(wiring);
      ASSERT_TRUE(explained(wiring, {GetParam()})) << yaw << " seed " << seed << text(wiring);
      ASSERT_LE(wiring.explanations.size(), 2U) << yaw << " seed " << seed << text(wiring);
    }
}

INSTANTIATE_TEST_SUITE_P(Wiring, OneFault,
                         ::testing::Values("sides_exchanged", "counts_exchanged", "motors_exchanged",
                                           "left_wheel_inverted", "right_wheel_inverted",
                                           "left_counts_inverted", "right_counts_inverted",
                                           "left_motor_inverted", "right_motor_inverted", "lidar_mirrored",
                                           "lidar_yaw"),
                         [](const auto& one) { return std::string(one.param); });

TEST(Wiring, names_both_sides_of_a_mirror) {
  const auto wiring = judge_wiring(Robot({"sides_exchanged"}).nudge(1));
  ASSERT_EQ(wiring.explanations.size(), 2U) << text(wiring);
  EXPECT_TRUE(explained(wiring, {"sides_exchanged"}) && explained(wiring, {"lidar_mirrored"}))
      << text(wiring);
  const auto sideways = judge_wiring(Robot({"sides_exchanged"}, 90.0 * kRadians, 90.0 * kRadians).nudge(1));
  ASSERT_EQ(sideways.explanations.size(), 1U)
      << "to a lidar that looks aside the mirror is no mirror" << text(sideways);
}

TEST(Wiring, of_two_faults_is_explained_by_them_or_by_no_more) {
  const std::vector<std::string> all{
      "counts_exchanged",    "motors_exchanged",      "left_counts_inverted", "right_motor_inverted",
      "left_wheel_inverted", "right_counts_inverted", "lidar_mirrored",       "lidar_yaw"};
  for (const auto& a : all)
    for (const auto& b : all) {
      if (a == b) continue;
      const auto wiring = judge_wiring(Robot({a, b}).nudge(3));
      ASSERT_EQ(wiring.outcome, Wiring::Outcome::wrong) << a << " " << b << text(wiring);
      const std::size_t count = wiring.explanations.front().size();
      ASSERT_LE(count, 2U) << a << " " << b << text(wiring);
      ASSERT_TRUE(count < 2 || explained(wiring, {a, b})) << a << " " << b << text(wiring);
    }
}

TEST(Wiring, without_a_lidar_is_not_called_good) {
  const auto wiring = judge_wiring(Robot({}).nudge(1, false));
  EXPECT_EQ(wiring.outcome, Wiring::Outcome::unclear);
  EXPECT_NE(wiring.why.find("lidar"), std::string::npos);
}

TEST(Wiring, of_a_wheel_that_does_not_count_is_unclear) {
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    Nudge nudge = Robot({}).nudge(1);
    nudge.ahead.counted[side] = nudge.left.counted[side] = 0.01;
    const auto wiring = judge_wiring(nudge);
    EXPECT_EQ(wiring.outcome, Wiring::Outcome::unclear);
    EXPECT_NE(wiring.why.find(side == 0 ? "left" : "right"), std::string::npos) << wiring.why;
  }
}

TEST(Wiring, that_nothing_explains_is_unclear) {
  Nudge nudge = Robot({}).nudge(1);
  nudge.left.seen = Pose{0.0, 0.0, 0.0};  // the wheels turn, the robot does not
  EXPECT_EQ(judge_wiring(nudge).outcome, Wiring::Outcome::unclear);
  nudge.wheel_radius = 0.0;
  EXPECT_EQ(judge_wiring(nudge).outcome, Wiring::Outcome::unclear);
}

TEST(NudgePlan, moves_a_few_centimetres_by_time_and_ends_where_it_began) {
  const auto seen = preview(nudge_plan({}));
  EXPECT_LT(seen.reach, 0.06);
  EXPECT_LT(seen.turn, 0.3);
  EXPECT_LT(seen.duration, 12.0);
  EXPECT_NEAR(seen.end.x, 0.0, 0.002);
  EXPECT_NEAR(seen.end.yaw, 0.0, 0.01);
}

}  // namespace
}  // namespace odomcalib::routines::wiring_test
