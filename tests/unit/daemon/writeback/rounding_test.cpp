#include "daemon/writeback/rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace odomcalib::rounding_test {
namespace {

using drivers::StoredParameter;

std::vector<StoredParameter> grid(double step) {
  return {{"left_wheel_diameter", 0, 0.150, step},
          {"right_wheel_diameter", 0, 0.150, step},
          {"track_width", 0, 0.400, step}};
}

std::map<std::string, double> wanted(double left, double right, double track) {
  return {{"left_wheel_diameter", left}, {"right_wheel_diameter", right}, {"track_width", track}};
}

double cost(const RoundingError& e) { return std::hypot(e.length, 0.5 * e.heading, e.turn); }

TEST(Rounding, values_on_the_grid_stay_and_nothing_remains) {
  const auto rounded = round_together(wanted(0.151, 0.149, 0.402), grid(1e-3));
  EXPECT_NEAR(rounded.values.at("left_wheel_diameter"), 0.151, 1e-12);
  EXPECT_NEAR(cost(rounded.remaining), 0.0, 1e-9);
}

// 0.1504 and 0.1506 would go to 0.150 and 0.151, each to its nearest: a robot that pulls to the left by 1 mm
// of diameter on 0.4 m of track. Both to the same side keeps it straight, at 0.3 % of length.
TEST(Rounding, keeping_the_robot_straight_goes_before_the_nearest_value) {
  const auto rounded = round_together(wanted(0.1504, 0.1506, 0.400), grid(1e-3));
  EXPECT_EQ(rounded.values.at("left_wheel_diameter"), rounded.values.at("right_wheel_diameter"));
  EXPECT_NEAR(std::abs(rounded.remaining.length), 0.5 / 150.5, 1e-4);
}

TEST(Rounding, is_never_worse_than_each_value_to_its_nearest) {
  std::mt19937 random(7);
  std::printf("seed 7\n");
  std::uniform_real_distribution<double> spread(-0.01, 0.01);
  int better = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto exact = wanted(0.150 + spread(random), 0.150 + spread(random), 0.400 + spread(random));
    std::map<std::string, double> nearest;
    for (const auto& [name, value] : exact) nearest[name] = 1e-3 * std::round(value / 1e-3);
    const auto together = round_together(exact, grid(1e-3));
    const double mean = 0.5 * (nearest["left_wheel_diameter"] + nearest["right_wheel_diameter"]);
    const double true_mean = 0.5 * (exact.at("left_wheel_diameter") + exact.at("right_wheel_diameter"));
    const double heading =
        (nearest["right_wheel_diameter"] - nearest["left_wheel_diameter"]) / (nearest["track_width"] * mean) -
        (exact.at("right_wheel_diameter") - exact.at("left_wheel_diameter")) /
            (exact.at("track_width") * true_mean);
    const RoundingError alone{mean / true_mean - 1.0, heading,
                              mean / nearest["track_width"] / (true_mean / exact.at("track_width")) - 1.0};
    ASSERT_LE(cost(together.remaining), cost(alone) + 1e-12);
    better += cost(together.remaining) < 0.9 * cost(alone) ? 1 : 0;
  }
  EXPECT_GT(better, 100);
}

TEST(Rounding, what_the_controller_does_not_hold_stays_exact) {
  const auto exact = wanted(0.1504, 0.1506, 0.4003);
  EXPECT_EQ(round_together(exact, {}).values, exact);
  const auto partly = round_together(exact, {{"left_wheel_diameter", 0, 0.150, 1e-3}});
  EXPECT_EQ(partly.values.at("track_width"), 0.4003);
  EXPECT_EQ(partly.values.at("right_wheel_diameter"), 0.1506);
}

TEST(Rounding, incomplete_sets_are_left_to_the_controller) {
  const std::map<std::string, double> one{{"track_width", 0.4003}};
  EXPECT_EQ(round_together(one, grid(1e-3)).values, one);
}

}  // namespace
}  // namespace odomcalib::rounding_test
