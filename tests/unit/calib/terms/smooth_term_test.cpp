// Laws that smooth terms can describe, and how they act.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::terms::smooth_term_test {
namespace {

TEST(SmoothTerm, is_zero_at_rest_but_on_the_turn_path) {
  for (int v = 0; v <= static_cast<int>(vehicle::kLastCovariate); ++v) {
    const auto covariate = static_cast<vehicle::Covariate>(v);
    if (begins_with_the_recording(covariate) || is_distance_since(covariate)) continue;
    const SmoothTerm smooth{{covariate, vehicle::Channel::both_travel}, -0.7, 0.9};
    for (const double f : functions_of(smooth, vehicle::StepContext{}))
      EXPECT_NEAR(f, 0.0, 1e-12) << to_string(covariate);
  }
  const SmoothTerm turn{{vehicle::Covariate::turn_rate, vehicle::Channel::turn_path}, -1.0, 1.0};
  EXPECT_EQ(functions_of(turn, vehicle::StepContext{})[0], 1.0);
}

TEST(SmoothTerm, of_a_speed_is_zero_at_rest_with_any_knots) {
  const SmoothTerm hats{{vehicle::Covariate::speed, vehicle::Channel::both_travel}, -0.5, 0.5};
  for (const SmoothTerm& smooth : {hats, on_basis(hats, Splines{8}), on_basis(hats, Splines{})})
    for (const double f : functions_of(smooth, vehicle::StepContext{}))
      EXPECT_NEAR(f, 0.0, 1e-12) << smooth.basis.index();
}

TEST(SmoothTerm, of_the_pace_is_the_same_both_ways) {
  const std::array pace = {
      vehicle::Dependence{vehicle::Covariate::acceleration, vehicle::Channel::both_travel},
      vehicle::Dependence{vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel},
      vehicle::Dependence{vehicle::Covariate::right_acceleration, vehicle::Channel::right_travel},
      vehicle::Dependence{vehicle::Covariate::turn_acceleration, vehicle::Channel::track}};
  const auto moving = [](double way, double push) {
    vehicle::StepContext c;
    c.speed = c.left_speed = c.right_speed = c.turn_rate = 0.3 * way;
    c.left_acceleration = c.right_acceleration = 0.5 * way * push;
    c.turn_acceleration_before.fill(0.5 * way * push);
    c.turn_acceleration_after.fill(0.5 * way * push);
    return c;
  };
  for (const vehicle::Dependence& dependence : pace) {
    SmoothTerm smooth{dependence, -1.0, 1.0};
    smooth.with_motion = true;
    for (const double push : {-1.0, 1.0}) {
      const BasisValues ahead = functions_of(smooth, moving(1.0, push)),
                        back = functions_of(smooth, moving(-1.0, push));
      EXPECT_NEAR(ahead[0], 0.5 * push, 1e-12) << to_string(dependence.covariate);
      for (std::size_t k = 0; k < ahead.size(); ++k)
        EXPECT_EQ(ahead[k], back[k]) << to_string(dependence.covariate);
    }
  }
}

/// Largest error of the smooth term that is nearest to a smooth bump, relative to its height.
double misfit_of_bump(const SmoothTerm& smooth) {
  constexpr int kSpeeds = 200;
  const auto functions = static_cast<Eigen::Index>(function_count(smooth));
  Eigen::MatrixXd columns(kSpeeds, functions);
  Eigen::VectorXd bump(kSpeeds);
  for (int k = 0; k < kSpeeds; ++k) {
    vehicle::StepContext c;
    c.speed = 0.5 * (k + 1) / kSpeeds;
    const BasisValues values = functions_of(smooth, c);
    columns.row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    bump(k) = std::exp(-std::pow((c.speed - 0.27) / 0.06, 2));
  }
  const Eigen::VectorXd nearest = columns.colPivHouseholderQr().solve(bump);
  return (columns * nearest - bump).cwiseAbs().maxCoeff();
}

TEST(SmoothTerm, splines_describe_a_bump_better) {
  const SmoothTerm coarse{{vehicle::Covariate::speed, vehicle::Channel::both_travel}, -0.5, 0.5};
  const auto shapes = other_shapes(coarse, {});
  ASSERT_EQ(shapes.size(), kRoughness.size());
  EXPECT_TRUE(
      other_shapes({{vehicle::Covariate::heading, vehicle::Channel::both_travel}, -1.0, 1.0}, {}).empty());
  EXPECT_LT(misfit_of_bump(shapes.front()), 0.005);
  EXPECT_GT(misfit_of_bump(coarse), 0.1);
}

TEST(SmoothTerm, of_splines_expects_straight_lines) {
  const SmoothTerm coarse{{vehicle::Covariate::speed, vehicle::Channel::both_travel}, -0.5, 0.5};
  EXPECT_TRUE(make_smooth_term_effect(coarse)->expected_zeros().empty());
  for (const SmoothTerm& shape : other_shapes(coarse, {})) {
    const auto rows = make_smooth_term_effect(shape)->expected_zeros();
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(kMostKnots) - 1);
    for (const std::vector<double>& row : rows) {
      double of_line = 0.0, of_parabola = 0.0;
      for (std::size_t k = 0; k < row.size(); ++k) {
        const auto x = static_cast<double>(k);
        of_line += row[k] * (3.0 + 2.0 * x);
        of_parabola += row[k] * x * x;
      }
      EXPECT_NEAR(of_line, 0.0, 1e-9);
      EXPECT_NEAR(of_parabola, 2.0 / (std::get<Splines>(shape.basis).roughness.front() * 5e-3), 1e-6)
          << "second difference of x^2 is 2";
    }
  }
}

TEST(SmoothTerm, may_be_as_rough_as_it_was_found) {
  const SmoothTerm smooth =
      other_shapes({{vehicle::Covariate::speed, vehicle::Channel::both_travel}, -0.5, 0.5}, {}).front();
  std::vector<double> coefficients(function_count(smooth), 0.0);
  coefficients[12] = 0.02;  // one kink, far from both ends
  const auto shapes = as_rough_as(smooth, coefficients);
  ASSERT_FALSE(shapes.empty());
  const std::vector<double>& roughness = std::get<Splines>(shapes.front().basis).roughness;
  EXPECT_NEAR(roughness[2], kRoughness.front(), 1e-12);
  EXPECT_NEAR(roughness[20], kRoughness.front(), 1e-12);
  EXPECT_GT(roughness[11], 3.0);
  EXPECT_TRUE(
      as_rough_as({{vehicle::Covariate::speed, vehicle::Channel::both_travel}, -0.5, 0.5}, coefficients)
          .empty());
}

/// Misfit of the best sum of the smooth term's functions and a constant to a rug: 1 in a square, 0 elsewhere.
double misfit_of_rug(const SmoothTerm& smooth) {
  constexpr int kSteps = 30;  // each way
  const auto functions = static_cast<Eigen::Index>(function_count(smooth));
  Eigen::MatrixXd columns(kSteps * kSteps, functions + 1);
  Eigen::VectorXd rug(kSteps * kSteps);
  for (Eigen::Index k = 0; k < rug.size(); ++k) {
    vehicle::StepContext c;
    const Eigen::Index column = k % kSteps, row = k / kSteps;
    c.x = -1.0 + 2.0 * static_cast<double>(column) / (kSteps - 1);
    c.y = -1.0 + 2.0 * static_cast<double>(row) / (kSteps - 1);
    const BasisValues values = functions_of(smooth, c);
    columns.row(k) << 1.0, Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    rug(k) = std::max(std::abs(c.x - 0.4), std::abs(c.y - 0.3)) < 0.35 ? 1.0 : 0.0;
  }
  const Eigen::VectorXd nearest = columns.completeOrthogonalDecomposition().solve(rug);
  return (columns * nearest - rug).norm() / rug.norm();
}

TEST(SmoothTerm, patches_describe_a_rug_better_than_polynomials) {
  const SmoothTerm smooth{{vehicle::Covariate::position, vehicle::Channel::both_travel}, -1.0, 1.0};
  const auto shapes = other_shapes(smooth, {});
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_TRUE(basis_as<Patches>(shapes[0]));
  EXPECT_LT(misfit_of_rug(shapes[0]), 0.8 * misfit_of_rug(smooth));
  for (const double place : {-3.0, -0.9, 0.0, 0.37, 1.0, 8.0}) {
    vehicle::StepContext c;
    c.x = place;
    c.y = -0.7 * place;
    const BasisValues values = functions_of(shapes[0], c);
    EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), 1.0, 1e-12) << place;
  }
}

TEST(SmoothTerm, its_spread_is_that_of_the_law_over_the_drive) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  const SmoothTerm wave =
      on_basis({{vehicle::Covariate::left_phase, vehicle::Channel::left_travel}, 0.0, 1.0}, Harmonics{5});
  // Root mean square of a sine, as the wheel passes all its angles alike.
  EXPECT_NEAR(spread_of(wave, std::vector<double>{0.01, 0.0}, models), 0.01 / std::sqrt(2.0), 2e-4);
}

TEST(SmoothTerm, about_its_mean_it_has_none_over_the_drive) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  const SmoothTerm smooth =
      centred({{vehicle::Covariate::left_speed, vehicle::Channel::left_travel}, -0.8, 0.8}, models);
  std::vector<double> sum(function_count(smooth), 0.0);
  double way = 0.0;
  for (const vehicle::StepContext& c : model.context()) {
    way += std::abs(c.left_delta);
    for (std::size_t k = 0; k < sum.size(); ++k)
      sum[k] += std::abs(c.left_delta) * functions_of(smooth, c)[k];
  }
  for (const double value : sum) EXPECT_NEAR(value / way, 0.0, 1e-12);
  const std::vector<terms::FittedSmoothTerm> written = {{smooth, std::vector<double>(sum.size(), 0.01), ""}};
  const auto read = terms::smooth_terms_of(terms::entries_of(written));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].smooth.mean, smooth.mean);
}

TEST(SmoothTerm, of_each_wheel_acts_on_both_by_their_own_speeds) {
  SmoothTerm smooth{vehicle::kOfEachWheel, -0.4, 0.4};
  ASSERT_EQ(acts_on(smooth).size(), 2U);
  std::vector<double> coefficients(function_count(smooth), 0.0);
  coefficients[3] = 0.01;  // at the highest speed
  vehicle::StepContext c;
  c.left_speed = 0.4;
  c.right_speed = -0.2;
  vehicle::WheelStep<double> step{0.006, -0.003};
  make_smooth_term_effect(smooth)->apply(c, coefficients, step);
  EXPECT_NEAR(step.left, 0.006 * 1.01, 1e-12);
  EXPECT_NEAR(step.right, -0.003, 1e-12);
  std::swap(c.left_speed, c.right_speed);
  step = {-0.003, 0.006};
  make_smooth_term_effect(smooth)->apply(c, coefficients, step);
  EXPECT_NEAR(step.left, -0.003, 1e-12);
  EXPECT_NEAR(step.right, 0.006 * 1.01, 1e-12);
  EXPECT_EQ(acts_on({{vehicle::Covariate::left_speed, vehicle::Channel::left_travel}}).size(), 1U);
}

TEST(SmoothTerm, of_each_wheel_is_spread_over_the_ways_of_both) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  SmoothTerm smooth{vehicle::kOfEachWheel};
  std::tie(smooth.low, smooth.high) = range_of(smooth.dependence.covariate, models);
  const SmoothTerm about_mean = centred(smooth, models);
  double sum = 0.0;
  for (const vehicle::StepContext& c : model.context())
    sum += std::abs(c.left_delta) * functions_of(about_mean, c, 0)[2] +
           std::abs(c.right_delta) * functions_of(about_mean, c, 1)[2];
  EXPECT_NEAR(sum, 0.0, 1e-9);
}

TEST(SmoothTerm, every_carrier_acts_and_reverses_as_it_says) {
  vehicle::StepContext ahead;
  ahead.dt = 0.02;
  ahead.speed = 0.3;
  ahead.turn_rate = 0.5;
  ahead.left_delta = ahead.right_delta = 0.08;
  vehicle::StepContext back = ahead;
  back.speed = -0.3;
  back.turn_rate = -0.5;
  back.left_delta = back.right_delta = -0.08;
  for (int c = 0; c <= static_cast<int>(vehicle::kLastChannel); ++c) {
    const auto channel = static_cast<vehicle::Channel>(c);
    const auto change = [&](const vehicle::StepContext& context) {
      vehicle::WheelStep<double> step{0.006, 0.006};
      if (context.speed < 0.0) step.left = step.right = -0.006;
      const vehicle::WheelStep<double> before = step;
      carry(channel, context, 0.01, step);
      return std::array{step.left - before.left, step.right - before.right, step.side, step.yaw,
                        step.track - 1.0};
    };
    const auto forth = change(ahead), reverse = change(back);
    const bool signed_by_motion =
        channel == vehicle::Channel::left_travel || channel == vehicle::Channel::right_travel ||
        channel == vehicle::Channel::both_travel || channel == vehicle::Channel::sideways ||
        channel == vehicle::Channel::turn_side || channel == vehicle::Channel::turn_ahead ||
        channel == vehicle::Channel::way_turned || channel == vehicle::Channel::scale;
    constexpr std::size_t kTrack = 4;
    double largest = 0.0;
    for (std::size_t k = 0; k < forth.size(); ++k) {
      EXPECT_NEAR(reverse[k], signed_by_motion && k != kTrack ? -forth[k] : forth[k], 1e-15)
          << to_string(channel);
      largest = std::max(largest, std::abs(forth[k]));
    }
    EXPECT_GT(largest, 0.0) << to_string(channel);
  }
}

TEST(SmoothTerm, survives_the_calibration_file) {
  const SmoothTerm smooth =
      on_basis({{vehicle::Covariate::time, vehicle::Channel::both_travel}, 0.0, 290.0}, Cycle{61.5});
  SmoothTerm tiles{{vehicle::Covariate::position, vehicle::Channel::both_travel}};
  tiles.basis = Wave{3.0, -0.5};
  const SmoothTerm rug =
      other_shapes({{vehicle::Covariate::position, vehicle::Channel::both_travel}, -1.0, 1.0}, {}).front();
  SmoothTerm brake{{vehicle::Covariate::left_acceleration, vehicle::Channel::left_travel}, -0.8, 0.8};
  brake.with_motion = true;
  const auto read = terms::smooth_terms_of(terms::entries_of({{smooth, {0.01, -0.02}, "drift_with_time"},
                                                              {tiles, {0.01, 0.0, 0.0, 0.0}, ""},
                                                              {rug, std::vector<double>(16, 0.01), ""},
                                                              {brake, std::vector<double>(4, 0.01), ""}}));
  ASSERT_EQ(read.size(), 4U);
  EXPECT_EQ(read[3].smooth, brake);
  EXPECT_EQ(read[2].smooth, rug);
  EXPECT_EQ(read[1].smooth, tiles);
  EXPECT_EQ(read[0].smooth, smooth);
  EXPECT_EQ(read[0].coefficients, (std::vector<double>{0.01, -0.02}));
  EXPECT_EQ(read[0].named_term, "drift_with_time");
  // Files of earlier versions do not say what could not be chosen then.
  SmoothTermEntry of_a_newer_program;
  EXPECT_EQ(of_a_newer_program.knots, kKnots);
  EXPECT_EQ(of_a_newer_program.degree, kHighestDegree);
  EXPECT_EQ(of_a_newer_program.memory, vehicle::kUsualMemory);
  of_a_newer_program.variable = "mood";
  of_a_newer_program.carrier = "track";
  of_a_newer_program.high = 1.0;
  EXPECT_TRUE(terms::smooth_terms_of({of_a_newer_program}).empty());
}

}  // namespace
}  // namespace odomcalib::calib::terms::smooth_term_test
