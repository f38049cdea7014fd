#include "calib/classical/rest_to_rest.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/classical/manual.hpp"
#include "tests/unit/calib/synthetic.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::calib::classical::rest_to_rest_test {
namespace {

using odomcalib::test_support::sensor_motion_by_hand;

const wheels::BaseParameters kNominal{0.075, 0.075, 0.4, {}};
const wheels::BaseParameters kTruth{0.0764, 0.0759, 0.409, {}};

/// Wheels that turn by these angles on the true robot.
StraightMove straight_move(double left, double right) {
  const math::Pose seen = sensor_motion_by_hand(kTruth, left, right);
  return {{left, right}, std::hypot(seen.x, seen.y), seen.yaw};
}

SpinMove spin_move(double turns) {
  const double wheel = turns * 2.0 * math::kPi * kNominal.track_width / 2.0 / kNominal.left_radius;
  return {{-wheel, wheel}, sensor_motion_by_hand(kTruth, -wheel, wheel).yaw};
}

/// Square run of a robot with these lengths that believes in the nominal ones.
SquareRun square_run(const wheels::BaseParameters& truth, double side, double direction) {
  const double straight = side / kNominal.left_radius;
  const double turn = direction * math::kPi / 4.0 * kNominal.track_width / kNominal.left_radius;
  SquareRun run;
  for (int k = 0; k < 4; ++k) {
    run.moves.push_back({straight, straight});
    run.moves.push_back({-turn, turn});
  }
  for (const WheelTurns& move : run.moves) {
    const math::Pose step = sensor_motion_by_hand(truth, move.left, move.right);
    const double c = std::cos(run.end.yaw), s = std::sin(run.end.yaw);
    run.end = {run.end.x + c * step.x - s * step.y, run.end.y + s * step.x + c * step.y,
               run.end.yaw + step.yaw};
  }
  return run;
}

SquarePair square_pair(const wheels::BaseParameters& truth, double side) {
  return {square_run(truth, side, 1.0), square_run(truth, side, -1.0)};
}

TEST(GeometryErrors, S1_01_factors_and_lengths_say_the_same) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> factor(0.8, 1.25);
  for (int k = 0; k < 10000; ++k) {
    const wheels::BaseParameters nominal{
        0.075 * factor(engine), 0.075 * factor(engine), 0.4 * factor(engine), {}};
    const wheels::BaseParameters truth{
        0.075 * factor(engine), 0.075 * factor(engine), 0.4 * factor(engine), {}};
    const wheels::BaseParameters back = with_errors(nominal, errors_of(truth, nominal));
    EXPECT_NEAR(back.left_radius, truth.left_radius, 1e-14);
    EXPECT_NEAR(back.right_radius, truth.right_radius, 1e-14);
    EXPECT_NEAR(back.track_width, truth.track_width, 1e-14);
  }
}

/// Motion of a robot with these errors whose wheels are commanded a metre, or a turn.
math::Pose commanded_metre(const wheels::BaseParameters& nominal, const GeometryErrors& errors) {
  const double turn = 1.0 / nominal.left_radius;
  return sensor_motion_by_hand(with_errors(nominal, errors), turn, turn);
}
double commanded_turn(const wheels::BaseParameters& nominal, const GeometryErrors& errors) {
  const double wheel = math::kPi * nominal.track_width / nominal.left_radius;
  return sensor_motion_by_hand(with_errors(nominal, errors), -wheel, wheel).yaw / (2.0 * math::kPi);
}

TEST(GeometryErrors, S1_02_each_has_its_own_effect_on_a_metre_and_on_a_turn) {
  const wheels::BaseParameters nominal{0.075, 0.075, 0.3, {}};
  EXPECT_NEAR(commanded_metre(nominal, {1.01, 1.0, 1.0}).x, 1.01, 1e-12);
  EXPECT_NEAR(commanded_turn(nominal, {1.01, 1.0, 1.0}), 1.01, 1e-12);
  EXPECT_NEAR(commanded_metre(nominal, {1.0, 1.0, 1.01}).x, 1.0, 1e-12);
  EXPECT_NEAR(commanded_metre(nominal, {1.0, 1.0, 1.01}).yaw, 0.0, 1e-12);
  EXPECT_NEAR(commanded_turn(nominal, {1.0, 1.0, 1.01}), 1.0 / 1.01, 1e-12);
  const double bent = 2.0 * (1.01 - 1.0) / ((1.01 + 1.0) * 0.3);
  EXPECT_NEAR(commanded_metre(nominal, {1.0, 1.01, 1.0}).yaw / bent, 1.0, 1e-12);
  EXPECT_NEAR(bent, 0.0332, 5e-5);
  EXPECT_NEAR(commanded_turn(nominal, {1.0, 1.01, 1.0}), 1.0, 1e-12);
}

TEST(StraightMoves, S1_03_one_repetition_gives_both_radii) {
  for (const double way : {13.0, -13.0}) {
    const std::vector<StraightMove> moves = {straight_move(way, way)};
    const auto proposal =
        value_of(propose_radii(moves, {kNominal.left_radius, kNominal.right_radius, kTruth.track_width, {}}));
    EXPECT_NEAR(proposal.left.mean, kTruth.left_radius, 1e-9);
    EXPECT_NEAR(proposal.right.mean, kTruth.right_radius, 1e-9);
    EXPECT_LT(proposal.left.std, 0.0) << "one repetition shows no spread";
  }
}

TEST(StraightMoves, S1_07_headings_show_unequal_wheels_and_a_tape_does_not) {
  std::vector<StraightMove> moves = {straight_move(13.0, 13.0), straight_move(-13.0, -13.0)};
  const auto seen = value_of(propose_radii(moves, kNominal));
  // The track width is off by 2 %, and with it the small difference of the radii.
  EXPECT_NEAR(seen.diameters->mean, kTruth.right_radius / kTruth.left_radius, 0.03 * 0.0066);
  for (StraightMove& move : moves) move.yaw.reset();
  const auto taped = value_of(propose_radii(moves, kNominal));
  EXPECT_FALSE(taped.diameters.has_value());
  EXPECT_DOUBLE_EQ(taped.left.mean, taped.right.mean);
  EXPECT_NEAR(taped.scale.mean, errors_of(kTruth, kNominal).scale, 1e-4);
}

TEST(StraightMoves, S1_05_the_stated_deviation_holds_however_few_repetitions) {
  std::mt19937 engine(5);
  std::normal_distribution<double> noise(0.0, 2e-3);
  for (const int repetitions : {2, 3, 6, 30}) {
    int inside = 0;
    constexpr int kTrials = 4000;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<StraightMove> moves(static_cast<std::size_t>(repetitions),
                                      {{10.0, 10.0}, 0.75, std::nullopt});
      for (StraightMove& move : moves) move.distance += noise(engine);
      const math::Repeated scale = propose_radii(moves, kNominal, {}).value().scale;
      if (std::abs(scale.mean - 1.0) < 1.96 * scale.std) ++inside;
    }
    EXPECT_NEAR(inside / static_cast<double>(kTrials), 0.95, 0.015) << repetitions << " repetitions";
  }
}

TEST(StraightMoves, what_is_no_straight_move_is_refused_with_the_cause) {
  const auto cause = [](const StraightMove& move) {
    const auto result = propose_radii(std::vector{move}, kNominal);
    return result ? std::string() : result.error().what;
  };
  EXPECT_NE(cause({{2.0, 2.0}, 0.15, 0.0}).find("0.2 m"), std::string::npos);
  EXPECT_NE(cause({{10.0, 10.0}, 0.7, 0.6}).find("half a radian"), std::string::npos);
  EXPECT_NE(cause({{10.0, -10.0}, 0.7, 0.0}).find("against each other"), std::string::npos);
  EXPECT_EQ(cause({{10.0, 10.0}, 0.7, 0.4}), "");
  EXPECT_EQ(propose_radii({}, kNominal).error().code, ErrorCode::empty);
}

TEST(SpinMoves, S1_04_one_turn_gives_the_track_width_whichever_way) {
  for (const double turns : {1.0, -1.0, 3.0}) {
    const std::vector<SpinMove> moves = {spin_move(turns)};
    const auto proposal = value_of(
        propose_track_width(moves, {kTruth.left_radius, kTruth.right_radius, kNominal.track_width, {}}));
    EXPECT_NEAR(proposal.track_width.mean, kTruth.track_width, 1e-9);
  }
  EXPECT_FALSE(propose_track_width(std::vector{spin_move(0.2)}, kNominal).ok()) << "less than a quarter turn";
  SpinMove against = spin_move(1.0);
  against.turn = -against.turn;
  EXPECT_FALSE(propose_track_width(std::vector{against}, kNominal).ok());
}

TEST(SpinMoves, S1_06_before_the_straight_line_the_track_inherits_the_error_of_the_diameters) {
  const auto proposal = value_of(propose_track_width(std::vector{spin_move(1.0)}, kNominal));
  EXPECT_NEAR(proposal.track_width.mean, kTruth.track_width / errors_of(kTruth, kNominal).scale, 1e-9);
}

TEST(Squares, S1_07_both_ways_separate_unequal_wheels_from_the_track) {
  for (const GeometryErrors errors :
       {GeometryErrors{1.0, 1.0, 1.03}, {1.0, 1.008, 1.0}, {1.0, 0.993, 0.98}, {1.02, 1.005, 1.01}}) {
    const wheels::BaseParameters truth = with_errors(kNominal, errors);
    const auto proposal = value_of(propose_from_squares(std::vector{square_pair(truth, 2.0)}, kNominal, 2.0));
    // The square shows the track in units of the wheels: their common scale is that of the straight line.
    const double shown = errors.track / errors.scale;
    const double exactness = errors.scale == 1.0 ? 1e-9 : 1e-3;
    EXPECT_NEAR(proposal.diameters.mean, errors.diameters, exactness);
    EXPECT_NEAR(proposal.track.mean, shown, exactness);
    // First order: a tenth of the error itself.
    EXPECT_NEAR(proposal.formula.diameters, errors.diameters, 0.1 * std::abs(errors.diameters - 1.0) + 5e-4);
    EXPECT_NEAR(proposal.formula.track, shown, 0.1 * std::abs(shown - 1.0) + 1e-3);
    if (errors.scale == 1.0) {
      EXPECT_LT(proposal.farthest_after, 0.1 * proposal.farthest_before);
    }
  }
}

// A lidar that is turned and shifted from where it is said to be sees ends that lie apart somewhere else.
TEST(Squares, a_lidar_that_sits_elsewhere_spoils_nothing) {
  const wheels::BaseParameters truth = with_errors(kNominal, {1.0, 0.993, 1.03});
  SquarePair pair = square_pair(truth, 1.0);
  const math::Pose moved{0.015, -0.01, 0.04};
  for (SquareRun* run : {&pair.ccw, &pair.cw}) {
    const double yaw = run->end.yaw;
    run->end = conjugate(run->end, moved);
    run->end.yaw = yaw;
  }
  const auto proposal = value_of(propose_from_squares(std::vector{pair}, kNominal, 1.0));
  EXPECT_NEAR(proposal.diameters.mean, 0.993, 2e-6);
  EXPECT_NEAR(proposal.track.mean, 1.03, 2e-6);
}

TEST(Squares, what_does_not_end_near_its_start_is_refused) {
  SquarePair pair = square_pair(kTruth, 2.0);
  pair.cw.end.x = 1.5;
  EXPECT_FALSE(propose_from_squares(std::vector{pair}, kNominal, 2.0).ok());
  pair = square_pair(kTruth, 2.0);
  pair.ccw.moves.pop_back();
  EXPECT_FALSE(propose_from_squares(std::vector{pair}, kNominal, 2.0).ok());
  EXPECT_FALSE(propose_from_squares({}, kNominal, 2.0).ok());
}

}  // namespace
}  // namespace odomcalib::calib::classical::rest_to_rest_test
