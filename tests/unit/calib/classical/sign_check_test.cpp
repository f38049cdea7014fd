// Every fault of signs and sides, put into motions made by hand, must be told by name; sound ones must pass.
#include "calib/classical/sign_check.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>

#include "tests/unit/calib/synthetic.hpp"

namespace odomcalib::calib::classical::sign_check_test {
namespace {

using odomcalib::test_support::random_motions;

struct Faults {
  bool exchanged = false, left = false, right = false, mirrored = false;
};

/// The middle of the lidar's pose stands neither on the axis of the robot nor across it.
const wheels::BaseParameters kRobot{0.075, 0.074, 0.4, {0.1, 0.02, 0.3}};

std::vector<wheels::WheelMotion> recorded(const wheels::BaseParameters& robot, const Faults& faults) {
  auto motions = random_motions(robot, 80, 5, 5e-4, 1e-3);
  for (wheels::WheelMotion& m : motions) {
    if (faults.left) m.left = -m.left;
    if (faults.right) m.right = -m.right;
    if (faults.exchanged) std::swap(m.left, m.right);
    if (faults.mirrored) m.sensor_motion = {m.sensor_motion.x, -m.sensor_motion.y, -m.sensor_motion.yaw};
  }
  return motions;
}

RobotDescription described(const wheels::BaseParameters& robot, bool with_lidar = true) {
  RobotDescription out{0.15, 0.15, 0.41, 4096.0, std::nullopt, "", ""};
  if (with_lidar) out.lidar_pose = {robot.mount.x, robot.mount.y, robot.mount.yaw + 0.1};
  return out;
}

std::string found(const Faults& faults, const wheels::BaseParameters& robot = kRobot,
                  bool with_lidar = true) {
  const auto error = check_signs(recorded(robot, faults), described(robot, with_lidar), false);
  return error ? error->what : "";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string kExchanged = "left and right counts are exchanged", kBoth = "both wheels count backwards",
                  kUpsideDown = "upside down", kElsewhere = "looks elsewhere";

TEST(SignCheck, lets_sound_motions_pass) {
  EXPECT_EQ(found({}), "");
  EXPECT_EQ(found({}, kRobot, false), "");
}

TEST(SignCheck, names_single_faults) {
  EXPECT_TRUE(holds(found({.exchanged = true}), kExchanged));
  EXPECT_TRUE(holds(found({.left = true}), "the left wheel counts backwards"));
  EXPECT_TRUE(holds(found({.right = true}), "the right wheel counts backwards"));
  EXPECT_TRUE(holds(found({.left = true, .right = true}), kBoth));
  EXPECT_TRUE(holds(found({.mirrored = true}), kUpsideDown));
}

TEST(SignCheck, names_nothing_beside_a_single_fault_where_the_lidar_stands_askew) {
  for (const Faults& faults :
       {Faults{.exchanged = true}, Faults{.left = true, .right = true}, Faults{.mirrored = true}})
    EXPECT_FALSE(holds(found(faults), ", or ")) << found(faults);
}

// A world seen in a mirror is a possible world.
TEST(SignCheck, names_both_sides_of_a_mirror) {
  wheels::BaseParameters ahead = kRobot;
  ahead.mount.yaw = 0.0;
  for (const Faults& faults : {Faults{.exchanged = true}, Faults{.mirrored = true}}) {
    const std::string text = found(faults, ahead);
    EXPECT_TRUE(holds(text, kExchanged) && holds(text, kUpsideDown)) << text;
    EXPECT_FALSE(holds(text, kBoth)) << text;
  }
}

TEST(SignCheck, leaves_all_three_open_where_the_lidar_pose_is_unknown) {
  const std::string text = found({.exchanged = true}, kRobot, false);
  EXPECT_TRUE(holds(text, kExchanged) && holds(text, kUpsideDown) && holds(text, kBoth)) << text;
}

TEST(SignCheck, leaves_front_and_back_to_the_estimate) {
  EXPECT_EQ(found({.exchanged = true, .left = true, .right = true}), "");
}

TEST(SignCheck, counts_a_lidar_that_looks_elsewhere_as_a_fault) {
  const std::string text = found({.exchanged = true, .left = true});
  EXPECT_TRUE(holds(text, kExchanged)) << text;
  EXPECT_TRUE(holds(text, kElsewhere)) << text;
}

TEST(SignCheck, knows_the_heading_of_a_base) {
  wheels::BaseParameters base = kRobot;
  base.mount = {};
  const auto error = check_signs(recorded(base, {.exchanged = true}), described(base, false), true);
  ASSERT_TRUE(error);
  // A reference with y and yaw the other way shows the same.
  EXPECT_TRUE(holds(error->what, kExchanged) &&
              holds(error->what, ", or y and yaw of the reference poses run"))
      << error->what;
  EXPECT_FALSE(check_signs(recorded(base, {}), described(base, false), true));
}

TEST(SignCheck, says_nothing_where_motions_do_not_tell) {
  auto straight = recorded(kRobot, {.exchanged = true});
  for (wheels::WheelMotion& m : straight) m = {m.left, m.left, {0.0745 * m.left, 0.0, 1e-4 * m.right}};
  EXPECT_FALSE(check_signs(straight, described(kRobot), false));
  EXPECT_FALSE(check_signs({}, described(kRobot), false));
}

TEST(SignCheck, refuses_wheels_that_turn_a_robot_that_stands) {
  auto standing = recorded(kRobot, {});
  for (wheels::WheelMotion& m : standing) m.sensor_motion = {2e-4, -1e-4, 1e-4};
  const auto error = check_signs(standing, described(kRobot), false);
  ASSERT_TRUE(error);
  EXPECT_TRUE(holds(error->what, "hardly moved")) << error->what;
}

TEST(SignCheck, leaves_four_times_the_counts_to_the_gate) {
  auto motions = recorded(kRobot, {});
  for (wheels::WheelMotion& m : motions) m.left *= 4.0, m.right *= 4.0;
  EXPECT_FALSE(check_signs(motions, described(kRobot), false));
}

TEST(SignCheck, accuses_nobody_by_few_motions) {
  auto motions = recorded(kRobot, {.exchanged = true});
  motions.resize(20);
  EXPECT_TRUE(check_signs(motions, described(kRobot), false));
  motions.resize(19);
  EXPECT_FALSE(check_signs(motions, described(kRobot), false));
}

TEST(SignCheck, accuses_nobody_where_other_signs_explain_hardly_more) {
  auto motions = recorded(kRobot, {.exchanged = true});
  // Matches that failed: rotations that belong to no motion of the wheels.
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (k % 4 != 0) motions[k].sensor_motion.yaw = k % 8 < 4 ? 1.5 : -1.5;
  EXPECT_FALSE(check_signs(motions, described(kRobot), false));
}

}  // namespace
}  // namespace odomcalib::calib::classical::sign_check_test
