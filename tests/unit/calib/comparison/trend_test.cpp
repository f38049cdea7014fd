#include "calib/comparison/trend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/unit/calib/comparison/calibrations.hpp"

namespace odomcalib::calib::comparison::trend_test {
namespace {

constexpr double kStd = 5e-5;  // m

/// A diameter once a month.
/// @param slope m a month
/// @param scatter of the values, over the deviation that is stated
std::vector<TrendPoint> monthly(std::mt19937& random, double slope, double scatter, int months = 12) {
  std::normal_distribution<double> normal;
  std::vector<TrendPoint> points;
  points.reserve(static_cast<std::size_t>(months));
  for (int k = 0; k < months; ++k)
    points.push_back({30.0 * k, 0.15 + slope * k + scatter * kStd * normal(random), kStd});
  return points;
}

TEST(WeightedLine, covers_the_slope_with_its_deviation) {
  std::mt19937 random(1);
  for (const double scatter : {1.0, 3.0}) {
    int covered = 0, false_alarms = 0;
    constexpr int kLines = 1000;
    for (int k = 0; k < kLines; ++k) {
      const auto line = weighted_line(monthly(random, -3e-5, scatter));
      ASSERT_TRUE(line);
      covered += std::abs(line->slope + 1e-6) < line->half_width * line->slope_std ? 1 : 0;
      false_alarms += weighted_line(monthly(random, 0.0, scatter))->is_significant() ? 1 : 0;
    }
    EXPECT_GT(covered, 0.94 * kLines) << "scatter " << scatter;
    EXPECT_LT(false_alarms, 0.02 * kLines) << "scatter " << scatter;
  }
}

TEST(WeightedLine, weighs_points_by_their_deviations) {
  const std::vector<TrendPoint> points{{0.0, 1.0, 0.1}, {1.0, 2.0, 0.1}, {2.0, 90.0, 1e3}};
  const auto line = weighted_line(points);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->slope, 1.0, 1e-3);
  EXPECT_EQ(line->last, 2.0);
}

TEST(WeightedLine, needs_two_times_and_positive_deviations) {
  EXPECT_FALSE(weighted_line(std::vector<TrendPoint>{{1.0, 1.0, 0.1}}));
  EXPECT_FALSE(weighted_line(std::vector<TrendPoint>{{1.0, 1.0, 0.1}, {1.0, 2.0, 0.1}}));
  EXPECT_FALSE(weighted_line(std::vector<TrendPoint>{{1.0, 1.0, 0.1}, {2.0, 2.0, 0.0}}));
  EXPECT_FALSE(weighted_line(std::vector<TrendPoint>{{1.0, 1.0, 0.1}, {2.0, std::nan(""), 0.1}}));
}

TEST(Crossing, holds_the_true_time_as_often_as_its_level_says) {
  std::mt19937 random(2);
  constexpr double kSlope = -5e-5, kBound = 0.15 + 25.0 * kSlope;  // passed after 25 months
  constexpr int kLines = 1000;
  int held = 0, bounded = 0;
  for (int k = 0; k < kLines; ++k) {
    const auto line = weighted_line(monthly(random, kSlope, 1.0));
    ASSERT_TRUE(line);
    const Crossing found = crossing(*line, kBound, 0.16);
    if (!found.at) continue;
    ASSERT_TRUE(found.earliest && found.latest);
    ++bounded;
    held += *found.earliest <= 750.0 && 750.0 <= *found.latest ? 1 : 0;
    EXPECT_LE(*found.earliest, *found.at);
    EXPECT_LE(*found.at, *found.latest);
  }
  EXPECT_GT(bounded, 0.99 * kLines);
  EXPECT_GT(held, 0.93 * bounded);
}

// Where the level alone is uncertain the interval is as wide as it is over the slope.
TEST(Crossing, has_the_uncertainty_of_level_and_slope) {
  const Line level{.centre = 0.0,
                   .level = 1.0,
                   .slope = -1.0,
                   .level_std = 0.1,
                   .slope_std = 0.0,
                   .scatter = 1.0,
                   .scatter_p = 1.0,
                   .p_value = 0.0,
                   .half_width = 2.0,
                   .last = 0.0,
                   .points = 9};
  const Crossing found = crossing(level, 0.0, 9.0);
  EXPECT_NEAR(found.at.value(), 1.0, 1e-9);
  EXPECT_NEAR(found.earliest.value(), 0.8, 1e-9);
  EXPECT_NEAR(found.latest.value(), 1.2, 1e-9);
  Line slope = level;
  slope.level_std = 0.0;
  slope.slope_std = 0.1;
  const Crossing wider = crossing(slope, 0.0, 9.0);
  EXPECT_NEAR(wider.earliest.value(), 1.0 / 1.2, 1e-9);
  EXPECT_NEAR(wider.latest.value(), 1.0 / 0.8, 1e-9);
}

// Nobody can say when what may stand still passes anything, but until when it certainly has not.
TEST(Crossing, of_a_line_that_may_be_level_has_no_time_but_an_earliest_one) {
  std::mt19937 random(3);
  const auto line = weighted_line(monthly(random, 0.0, 1.0));
  ASSERT_TRUE(line);
  ASSERT_FALSE(line->is_significant());
  const Crossing found = crossing(*line, 0.149, 0.151);
  EXPECT_FALSE(found.at);
  EXPECT_FALSE(found.latest);
  ASSERT_TRUE(found.earliest);
  EXPECT_GT(*found.earliest, line->last);
}

TEST(Crossing, of_a_bound_that_was_passed_already_is_the_last_point) {
  std::mt19937 random(4);
  const auto line = weighted_line(monthly(random, -5e-4, 1.0));
  ASSERT_TRUE(line);
  const Crossing found = crossing(*line, 0.149, 0.151);
  EXPECT_EQ(found.at, line->last);
  EXPECT_EQ(found.earliest, line->last);
  EXPECT_EQ(found.latest, line->last);
}

// Tyres that lose 30 um of diameter a km, on a robot of 5 km a month.
TEST(ParameterTrends, find_the_wear_of_tyres_and_when_a_metre_passes_a_bound) {
  constexpr double kWear = -30e-6 / 1000.0, kMonth = 5e3;  // m of diameter a m driven; m
  int near = 0, held = 0;
  constexpr int kRobots = 40;
  for (unsigned seed = 0; seed < kRobots; ++seed) {
    std::mt19937 random(seed);
    std::vector<Calibration> all;
    std::vector<double> driven;
    for (int month = 0; month < 12; ++month) {
      test_support::TrueState worn;
      worn.left += kWear * kMonth * month;
      worn.right += kWear * kMonth * month;
      all.push_back(test_support::drawn(worn, random));
      driven.push_back(kMonth * month);
    }
    const std::vector<ParameterTrend> trends = parameter_trends(test_support::views(all), driven);
    ASSERT_EQ(trends.size(), 7U);
    ASSERT_EQ(trends.front().name, kMeanDiameter);
    const Line& line = trends.front().line.value();
    EXPECT_TRUE(line.is_significant());
    near += std::abs(line.slope - kWear) < 2.0 * line.slope_std ? 1 : 0;
    // By the values of the newest calibration, whatever its own error.
    const double in_force = trends.front().points.back().value;
    const double truth = (in_force / 1.005 - 0.5 * (0.15 + 0.1502)) / kWear;
    const Crossing found = passing(trends, 0.005).value_or(Crossing{});
    ASSERT_TRUE(found.at && found.earliest && found.latest);
    held += *found.earliest <= truth && truth <= *found.latest ? 1 : 0;
  }
  EXPECT_GE(near, 35) << "95 in 100 lie within two deviations";
  EXPECT_GE(held, 35);
}

}  // namespace
}  // namespace odomcalib::calib::comparison::trend_test
