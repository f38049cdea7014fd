// What curves can describe, and how they act.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "calib/selection/law_shape.hpp"
#include "calib/selection/tracing_json.hpp"
#include "calib/terms/candidate_curves.hpp"
#include "calib/terms/curve.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/terms/curve_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::terms {
namespace {

TEST(Curve, is_zero_at_rest_but_on_the_turn_path) {
  for (int v = 0; v <= static_cast<int>(vehicle::kLastVariable); ++v) {
    const auto variable = static_cast<vehicle::Variable>(v);
    if (begins_with_the_recording(variable) || is_distance_since(variable)) continue;
    const Curve curve{{variable, vehicle::Carrier::both_travel}, -0.7, 0.9};
    for (const double f : functions_of(curve, vehicle::StepContext{}))
      EXPECT_NEAR(f, 0.0, 1e-12) << to_string(variable);
  }
  const Curve turn{{vehicle::Variable::turn_rate, vehicle::Carrier::turn_path}, -1.0, 1.0};
  EXPECT_EQ(functions_of(turn, vehicle::StepContext{})[0], 1.0);
}

TEST(Curve, of_a_speed_is_zero_at_rest_with_any_knots) {
  const Curve hats{{vehicle::Variable::speed, vehicle::Carrier::both_travel}, -0.5, 0.5};
  for (const Curve& curve : {hats, on_basis(hats, Splines{8}), on_basis(hats, Splines{})})
    for (const double f : functions_of(curve, vehicle::StepContext{}))
      EXPECT_NEAR(f, 0.0, 1e-12) << curve.basis.index();
}

TEST(Curve, of_the_pace_is_the_same_both_ways) {
  const std::array pace = {
      vehicle::Law{vehicle::Variable::acceleration, vehicle::Carrier::both_travel},
      vehicle::Law{vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel},
      vehicle::Law{vehicle::Variable::right_acceleration, vehicle::Carrier::right_travel},
      vehicle::Law{vehicle::Variable::turn_acceleration, vehicle::Carrier::track}};
  const auto moving = [](double way, double push) {
    vehicle::StepContext c;
    c.speed = c.left_speed = c.right_speed = c.turn_rate = 0.3 * way;
    c.left_acceleration = c.right_acceleration = 0.5 * way * push;
    c.turn_acceleration_before.fill(0.5 * way * push);
    c.turn_acceleration_after.fill(0.5 * way * push);
    return c;
  };
  for (const vehicle::Law& law : pace) {
    Curve curve{law, -1.0, 1.0};
    curve.with_motion = true;
    for (const double push : {-1.0, 1.0}) {
      const BasisValues ahead = functions_of(curve, moving(1.0, push)),
                        back = functions_of(curve, moving(-1.0, push));
      EXPECT_NEAR(ahead[0], 0.5 * push, 1e-12) << to_string(law.variable);
      for (std::size_t k = 0; k < ahead.size(); ++k) EXPECT_EQ(ahead[k], back[k]) << to_string(law.variable);
    }
  }
}

/// Largest error of the curve that is nearest to a smooth bump, relative to its height.
double misfit_of_bump(const Curve& curve) {
  constexpr int kSpeeds = 200;
  const auto functions = static_cast<Eigen::Index>(function_count(curve));
  Eigen::MatrixXd columns(kSpeeds, functions);
  Eigen::VectorXd bump(kSpeeds);
  for (int k = 0; k < kSpeeds; ++k) {
    vehicle::StepContext c;
    c.speed = 0.5 * (k + 1) / kSpeeds;
    const BasisValues values = functions_of(curve, c);
    columns.row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    bump(k) = std::exp(-std::pow((c.speed - 0.27) / 0.06, 2));
  }
  const Eigen::VectorXd nearest = columns.colPivHouseholderQr().solve(bump);
  return (columns * nearest - bump).cwiseAbs().maxCoeff();
}

TEST(Curve, splines_describe_a_bump_better) {
  const Curve coarse{{vehicle::Variable::speed, vehicle::Carrier::both_travel}, -0.5, 0.5};
  const auto shapes = other_shapes(coarse, {});
  ASSERT_EQ(shapes.size(), kRoughness.size());
  EXPECT_TRUE(
      other_shapes({{vehicle::Variable::heading, vehicle::Carrier::both_travel}, -1.0, 1.0}, {}).empty());
  EXPECT_LT(misfit_of_bump(shapes.front()), 0.005);
  EXPECT_GT(misfit_of_bump(coarse), 0.1);
}

TEST(Curve, of_splines_expects_straight_lines) {
  const Curve coarse{{vehicle::Variable::speed, vehicle::Carrier::both_travel}, -0.5, 0.5};
  EXPECT_TRUE(make_curve_effect(coarse)->expected_zeros().empty());
  for (const Curve& shape : other_shapes(coarse, {})) {
    const auto rows = make_curve_effect(shape)->expected_zeros();
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

TEST(Curve, may_be_as_rough_as_it_was_found) {
  const Curve smooth =
      other_shapes({{vehicle::Variable::speed, vehicle::Carrier::both_travel}, -0.5, 0.5}, {}).front();
  std::vector<double> coefficients(function_count(smooth), 0.0);
  coefficients[12] = 0.02;  // one kink, far from both ends
  const auto shapes = as_rough_as(smooth, coefficients);
  ASSERT_FALSE(shapes.empty());
  const std::vector<double>& roughness = std::get<Splines>(shapes.front().basis).roughness;
  EXPECT_NEAR(roughness[2], kRoughness.front(), 1e-12);
  EXPECT_NEAR(roughness[20], kRoughness.front(), 1e-12);
  EXPECT_GT(roughness[11], 3.0);
  EXPECT_TRUE(
      as_rough_as({{vehicle::Variable::speed, vehicle::Carrier::both_travel}, -0.5, 0.5}, coefficients)
          .empty());
}

/// Of the best sum of the curve's functions and a constant to what is 1 in a square and 0 elsewhere.
double misfit_of_rug(const Curve& curve) {
  constexpr int kSteps = 30;  // each way
  const auto functions = static_cast<Eigen::Index>(function_count(curve));
  Eigen::MatrixXd columns(kSteps * kSteps, functions + 1);
  Eigen::VectorXd rug(kSteps * kSteps);
  for (Eigen::Index k = 0; k < rug.size(); ++k) {
    vehicle::StepContext c;
    const Eigen::Index column = k % kSteps, row = k / kSteps;
    c.x = -1.0 + 2.0 * static_cast<double>(column) / (kSteps - 1);
    c.y = -1.0 + 2.0 * static_cast<double>(row) / (kSteps - 1);
    const BasisValues values = functions_of(curve, c);
    columns.row(k) << 1.0, Eigen::Map<const Eigen::RowVectorXd>(values.begin(), functions);
    rug(k) = std::max(std::abs(c.x - 0.4), std::abs(c.y - 0.3)) < 0.35 ? 1.0 : 0.0;
  }
  const Eigen::VectorXd nearest = columns.completeOrthogonalDecomposition().solve(rug);
  return (columns * nearest - rug).norm() / rug.norm();
}

TEST(Curve, patches_describe_a_rug_better_than_polynomials) {
  const Curve smooth{{vehicle::Variable::position, vehicle::Carrier::both_travel}, -1.0, 1.0};
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

TEST(Curve, its_spread_is_that_of_the_law_over_the_drive) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  const Curve wave =
      on_basis({{vehicle::Variable::left_phase, vehicle::Carrier::left_travel}, 0.0, 1.0}, Harmonics{5});
  // Root mean square of a sine, as the wheel passes all its angles alike.
  EXPECT_NEAR(spread_of(wave, std::vector<double>{0.01, 0.0}, models), 0.01 / std::sqrt(2.0), 2e-4);
}

TEST(Curve, about_its_mean_it_has_none_over_the_drive) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  const Curve curve =
      centred({{vehicle::Variable::left_speed, vehicle::Carrier::left_travel}, -0.8, 0.8}, models);
  std::vector<double> sum(function_count(curve), 0.0);
  double way = 0.0;
  for (const vehicle::StepContext& c : model.context()) {
    way += std::abs(c.left_delta);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::abs(c.left_delta) * functions_of(curve, c)[k];
  }
  for (const double value : sum) EXPECT_NEAR(value / way, 0.0, 1e-12);
  const std::vector<selection::FittedCurve> written = {{curve, std::vector<double>(sum.size(), 0.01), ""}};
  const auto read = selection::curves_from_json(curves_to_json(written));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].curve.mean, curve.mean);
}

TEST(Curve, of_each_wheel_acts_on_both_by_their_own_speeds) {
  Curve curve{vehicle::kOfEachWheel, -0.4, 0.4};
  ASSERT_EQ(acts_on(curve).size(), 2U);
  std::vector<double> coefficients(function_count(curve), 0.0);
  coefficients[3] = 0.01;  // at the highest speed
  vehicle::StepContext c;
  c.left_speed = 0.4;
  c.right_speed = -0.2;
  vehicle::WheelStep<double> step{0.006, -0.003};
  make_curve_effect(curve)->apply(c, coefficients, step);
  EXPECT_NEAR(step.left, 0.006 * 1.01, 1e-12);
  EXPECT_NEAR(step.right, -0.003, 1e-12);
  std::swap(c.left_speed, c.right_speed);
  step = {-0.003, 0.006};
  make_curve_effect(curve)->apply(c, coefficients, step);
  EXPECT_NEAR(step.left, -0.003, 1e-12);
  EXPECT_NEAR(step.right, 0.006 * 1.01, 1e-12);
  EXPECT_EQ(acts_on({{vehicle::Variable::left_speed, vehicle::Carrier::left_travel}}).size(), 1U);
}

TEST(Curve, of_each_wheel_is_spread_over_the_ways_of_both) {
  const vehicle::DriveModel model = selection::lively_model();
  const vehicle::DriveModel* models[] = {&model};
  Curve curve{vehicle::kOfEachWheel};
  std::tie(curve.low, curve.high) = range_of(curve.law.variable, models);
  const Curve about_mean = centred(curve, models);
  double sum = 0.0;
  for (const vehicle::StepContext& c : model.context())
    sum += std::abs(c.left_delta) * functions_of(about_mean, c, 0)[2] +
           std::abs(c.right_delta) * functions_of(about_mean, c, 1)[2];
  EXPECT_NEAR(sum, 0.0, 1e-9);
}

TEST(Curve, every_carrier_acts_and_reverses_as_it_says) {
  vehicle::StepContext ahead;
  ahead.dt = 0.02;
  ahead.speed = 0.3;
  ahead.turn_rate = 0.5;
  ahead.left_delta = ahead.right_delta = 0.08;
  vehicle::StepContext back = ahead;
  back.speed = -0.3;
  back.turn_rate = -0.5;
  back.left_delta = back.right_delta = -0.08;
  for (int c = 0; c <= static_cast<int>(vehicle::kLastCarrier); ++c) {
    const auto carrier = static_cast<vehicle::Carrier>(c);
    const auto change = [&](const vehicle::StepContext& context) {
      vehicle::WheelStep<double> step{0.006, 0.006};
      if (context.speed < 0.0) step.left = step.right = -0.006;
      const vehicle::WheelStep<double> before = step;
      carry(carrier, context, 0.01, step);
      return std::array{step.left - before.left, step.right - before.right, step.side, step.yaw,
                        step.track - 1.0};
    };
    const auto forth = change(ahead), reverse = change(back);
    const bool signed_by_motion =
        carrier == vehicle::Carrier::left_travel || carrier == vehicle::Carrier::right_travel ||
        carrier == vehicle::Carrier::both_travel || carrier == vehicle::Carrier::sideways ||
        carrier == vehicle::Carrier::turn_side || carrier == vehicle::Carrier::turn_ahead ||
        carrier == vehicle::Carrier::way_turned || carrier == vehicle::Carrier::scale;
    constexpr std::size_t kTrack = 4;
    double largest = 0.0;
    for (std::size_t k = 0; k < forth.size(); ++k) {
      EXPECT_NEAR(reverse[k], signed_by_motion && k != kTrack ? -forth[k] : forth[k], 1e-15)
          << to_string(carrier);
      largest = std::max(largest, std::abs(forth[k]));
    }
    EXPECT_GT(largest, 0.0) << to_string(carrier);
  }
}

TEST(Curve, survives_the_calibration_file) {
  const Curve curve =
      on_basis({{vehicle::Variable::time, vehicle::Carrier::both_travel}, 0.0, 290.0}, Cycle{61.5});
  Curve tiles{{vehicle::Variable::position, vehicle::Carrier::both_travel}};
  tiles.basis = Wave{3.0, -0.5};
  const Curve rug =
      other_shapes({{vehicle::Variable::position, vehicle::Carrier::both_travel}, -1.0, 1.0}, {}).front();
  Curve brake{{vehicle::Variable::left_acceleration, vehicle::Carrier::left_travel}, -0.8, 0.8};
  brake.with_motion = true;
  const auto read =
      selection::curves_from_json(selection::curves_to_json({{curve, {0.01, -0.02}, "drift_with_time"},
                                                             {tiles, {0.01, 0.0, 0.0, 0.0}, ""},
                                                             {rug, std::vector<double>(16, 0.01), ""},
                                                             {brake, std::vector<double>(4, 0.01), ""}}));
  ASSERT_EQ(read.size(), 4U);
  EXPECT_EQ(read[3].curve, brake);
  EXPECT_EQ(read[2].curve, rug);
  EXPECT_EQ(read[1].curve, tiles);
  EXPECT_EQ(read[0].curve, curve);
  EXPECT_EQ(read[0].coefficients, (std::vector<double>{0.01, -0.02}));
  EXPECT_EQ(read[0].law_of, "drift_with_time");
  EXPECT_TRUE(
      selection::curves_from_json(R"([{"variable":"mood","carrier":"track","low":0,"high":1}])").empty());
  EXPECT_TRUE(selection::curves_from_json("[{").empty());
}

/// A curve of an event in all that it may take, of which these are as likely as the best.
std::vector<selection::Reshaped> in_shapes(vehicle::Variable variable, std::size_t first, std::size_t count,
                                           std::initializer_list<std::size_t> likely) {
  std::vector<selection::Reshaped> shapes(count);
  for (std::size_t k = 0; k < count; ++k) {
    shapes[k].curve = {{variable, vehicle::Carrier::both_travel}, -1.0, 1.0, first + k};
    shapes[k].model.fit.cost = 900.0;
  }
  for (const std::size_t k : likely) shapes[k].model.fit.cost = 501.0;
  return shapes;
}

TEST(Curve, of_an_event_takes_the_middle_of_what_is_open) {
  const std::size_t relays = vehicle::kMemorySpans.size();
  const auto chosen = [](const std::vector<selection::Reshaped>& shapes) {
    return most_sensible_event(shapes, 502.0).curve.memory;
  };
  EXPECT_EQ(chosen(in_shapes(vehicle::Variable::since_stop, 0, vehicle::kStops.size(), {4, 6, 5})), 5U);
  EXPECT_EQ(chosen(in_shapes(vehicle::Variable::since_stop, 0, vehicle::kStops.size(), {7})), 7U);
  // No stop was too short: what shorter ones do was not seen.
  EXPECT_EQ(chosen(in_shapes(vehicle::Variable::since_stop, 0, vehicle::kStops.size(), {0, 1, 2, 3})), 3U);
  EXPECT_EQ(chosen(in_shapes(vehicle::Variable::previous_push, relays, vehicle::kPushes.size(), {0, 1, 2})),
            relays + 1);
  // What fades is another matter.
  EXPECT_EQ(chosen(in_shapes(vehicle::Variable::previous_push, 0, relays + vehicle::kPushes.size(),
                             {0, relays + 3})),
            relays + 3);
}

}  // namespace
}  // namespace odomcalib::calib::terms
