// Motions of a recording, counted by kind from hand-made counts.
#include "daemon/service/motion_count.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace odomcalib::motion_count_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

RobotDescription robot() {
  RobotDescription one;
  one.left_wheel_diameter = one.right_wheel_diameter = 0.1;
  one.track_width = 0.4;
  one.ticks_per_rev = 10'000;
  return one;
}

/// Drives in steps of a few millimetres.
class Driver {
 public:
  explicit Driver(MotionCount& count) : count_(count) { count_.add(at_, robot()); }
  void drive(double left, double right) {
    constexpr int kSteps = 200;
    const double ticks_per_m = robot().ticks_per_rev / (kPi * robot().left_wheel_diameter);
    for (int i = 0; i < kSteps; ++i) {
      at_.t += 0.02;
      at_.left += std::llround(left / kSteps * ticks_per_m);
      at_.right += std::llround(right / kSteps * ticks_per_m);
      count_.add(at_, robot());
    }
  }
  void reset_counters() {
    ++at_.segment;
    at_.left = at_.right = 0;
    count_.add(at_, robot());
  }

 private:
  MotionCount& count_;
  TickSample at_;
};

TEST(MotionCount, S0_21_tells_straight_left_and_right_apart_and_says_what_is_missing) {
  MotionCount count;
  Driver driver(count);
  EXPECT_THAT(count.missing(), ElementsAre(HasSubstr("straight lines: 0.00 of"), HasSubstr("turns: 0 of")));
  driver.drive(1.0, 1.0);
  EXPECT_THAT(count.missing(), ElementsAre(HasSubstr("turns: 0 of at least 90 degrees")));
  driver.drive(-1.0, -1.0);
  EXPECT_NEAR(count.straight().amount, 2.0, 0.2);
  EXPECT_NEAR(static_cast<double>(count.straight().stretches), 2.0 / 0.15, 1.5);
  EXPECT_EQ(count.left().stretches + count.right().stretches, 0U);
  driver.drive(-0.2 * kPi / 4, 0.2 * kPi / 4);  // 45 degrees
  EXPECT_THAT(count.missing(), ElementsAre(HasSubstr("turns: ")));
  driver.drive(0.2 * kPi, -0.2 * kPi);
  EXPECT_GT(count.left().stretches, 0U);
  EXPECT_NEAR(count.left().amount, kPi / 4, 0.25);
  EXPECT_NEAR(count.right().amount, kPi, 0.5);
  EXPECT_THAT(count.missing(), IsEmpty());
}

TEST(MotionCount, a_counter_that_starts_again_is_no_motion) {
  MotionCount count;
  Driver driver(count);
  driver.drive(5.0, 1.0);
  const double turned = count.right().amount;
  driver.reset_counters();
  EXPECT_EQ(count.right().amount, turned);
  EXPECT_EQ(count.left().stretches, 0U);
}

}  // namespace
}  // namespace odomcalib::motion_count_test
