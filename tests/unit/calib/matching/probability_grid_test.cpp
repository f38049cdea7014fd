#include "calib/matching/probability_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::calib::matching::probability_grid_test {
namespace {

const std::vector<Eigen::Vector2d> kBeam = {{2.02, 0.02}};

TEST(ProbabilityGrid, S2_40_one_beam_frees_its_path_and_occupies_its_end) {
  ProbabilityGrid grid({.cell = 0.05, .half_size = 15.0});
  grid.insert({}, kBeam);
  EXPECT_NEAR(grid.probability({2.02, 0.02}), 0.7, 1e-6);
  EXPECT_NEAR(grid.probability({1.0, 0.02}), 0.4, 1e-6);
  EXPECT_NEAR(grid.probability({0.01, 0.01}), 0.4, 1e-6);
  EXPECT_NEAR(grid.probability({2.5, 0.02}), 0.5, 1e-6) << "behind the wall";
  EXPECT_NEAR(grid.probability({1.0, 0.5}), 0.5, 1e-6) << "beside the beam";
}

TEST(ProbabilityGrid, odds_of_independent_beams_multiply_up_to_the_limit) {
  ProbabilityGrid grid({.cell = 0.05, .half_size = 15.0});
  grid.insert({}, kBeam);
  grid.insert({}, kBeam);
  const double odds = 0.7 / 0.3;
  EXPECT_NEAR(grid.probability({2.02, 0.02}), odds * odds / (1.0 + odds * odds), 1e-6);
  for (int i = 0; i < 100; ++i) grid.insert({}, kBeam);
  EXPECT_NEAR(grid.probability({2.02, 0.02}), 0.97, 1e-6);
  EXPECT_NEAR(grid.probability({1.0, 0.02}), 0.03, 1e-6);
}

TEST(ProbabilityGrid, what_moved_away_is_unlearnt) {
  ProbabilityGrid grid({.cell = 0.05, .half_size = 15.0});
  for (int i = 0; i < 100; ++i) grid.insert({}, kBeam);
  const std::vector<Eigen::Vector2d> farther = {{4.02, 0.04}};
  for (int i = 0; i < 20; ++i) grid.insert({}, farther);
  EXPECT_LT(grid.probability({2.02, 0.02}), 0.5);
}

TEST(ProbabilityGrid, the_sensor_may_stand_anywhere_and_beams_may_leave_the_map) {
  ProbabilityGrid grid({.cell = 0.05, .half_size = 3.0});
  grid.insert({1.0, 1.0, std::acos(-1.0) / 2.0}, kBeam);  // looks along y
  EXPECT_LT(grid.probability({1.0, 2.0}), 0.5);
  grid.insert({}, std::vector<Eigen::Vector2d>{{-50.0, 0.02}, {1e300, 1e300}});
  EXPECT_LT(grid.probability({-2.5, 0.02}), 0.5);
  EXPECT_EQ(grid.probability({-50.0, 0.02}), 0.5);
  grid.insert({100.0, 0.0, 0.0}, kBeam);
  EXPECT_EQ(grid.probability({2.9, 0.02}), 0.5);
}

}  // namespace
}  // namespace odomcalib::calib::matching::probability_grid_test
