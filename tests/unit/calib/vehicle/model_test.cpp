#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/step_context.hpp"

#include <gtest/gtest.h>

#include <random>

#include "calib/terms/catalogue.hpp"
#include "calib/vehicle/drive_history.hpp"
#include "calib/vehicle/sensitivity.hpp"
#include "tests/unit/calib/synthetic.hpp"

namespace odomcalib::calib::vehicle::model_test {
namespace {

const wheels::BaseParameters kBase{0.075, 0.074, 0.4, {0.1, 0.02, 0.3}};

/// Wheels that speed up, slow down and reverse independently.
wheels::WheelTrack lively_track() {
  wheels::WheelTrack track;
  for (int k = 0; k <= 2000; ++k) {
    const double t = 0.02 * k;
    track.t.push_back(t);
    track.left.push_back(8.0 * std::sin(0.31 * t) + 0.7 * t);
    track.right.push_back(7.0 * std::sin(0.43 * t + 0.5) + 0.8 * t);
    track.segment.push_back(0);
  }
  return track;
}

std::vector<Interval> some_intervals() {
  std::vector<Interval> intervals;
  // Never within a step of a tick sample: the delay's derivative jumps there.
  for (double t = 1.0137; t < 38.0; t += 0.74) intervals.push_back({t, t + 0.72});
  return intervals;
}

std::span<const double> as_span(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

TEST(DriveModel, predicts_the_circle_about_the_centre_of_rotation) {
  wheels::WheelTrack track{{0.0, 2.0}, {0.0, 3.0}, {0.0, 5.0}, {0, 0}};
  const DriveModel model(track, make_context(track, kBase));
  const std::vector<Interval> intervals = {{0.0, 2.0}, {0.5, 1.0}};
  const auto motions = model.predict(as_span(to_vector(kBase)), {}, intervals);
  const math::Pose whole = odomcalib::test_support::sensor_motion_by_hand(kBase, 3.0, 5.0);
  const math::Pose quarter = odomcalib::test_support::sensor_motion_by_hand(kBase, 0.75, 1.25);
  EXPECT_NEAR(motions[0].x, whole.x, 1e-12);
  EXPECT_NEAR(motions[0].y, whole.y, 1e-12);
  EXPECT_NEAR(motions[0].yaw, whole.yaw, 1e-12);
  EXPECT_NEAR(motions[1].x, quarter.x, 1e-12);
  EXPECT_NEAR(motions[1].yaw, quarter.yaw, 1e-12);
}

TEST(DriveModel, heading_and_place_follow_the_fixes_whatever_the_wheels_say) {
  const wheels::WheelTrack track = lively_track();
  const wheels::BaseParameters wrong{0.078, 0.074, 0.42, kBase.mount};
  const DriveModel nominal(track, make_context(track, wrong));
  const DriveModel truth(track, make_context(track, kBase));
  const Eigen::VectorXd p = to_vector(kBase);
  const Trajectory path = truth.trajectory(as_span(p), {});
  std::vector<Fix> fixes;
  for (double t = 0.05; t < 39.9; t += 0.1) fixes.push_back({t, path.at(t)});
  const auto worst = [&](const DriveModel& model) {
    double distance = 0.0;
    for (std::size_t k = 0; k < model.context().size(); ++k)
      distance = std::max(distance, std::hypot(model.context()[k].x - path.poses()[k].x,
                                               model.context()[k].y - path.poses()[k].y));
    return distance;
  };
  EXPECT_GT(worst(nominal), 0.05);
  EXPECT_LT(worst(DriveModel::located(nominal.track(), fixes, as_span(to_vector(wrong)), {})), 0.01);
  EXPECT_LT(worst(DriveModel::located(nominal.track(), {}, as_span(p), {})), 1e-12);
  EXPECT_GT(worst(nominal), 0.05) << "it stays as it was";
}

/// Wheels that speed up steadily, left with 3 rad/s^2 and right with 5.
double steadily(double rate, double t) { return 0.5 * rate * t * t; }

TEST(DriveModel, between_samples_wheels_speed_up_as_they_do_from_one_to_the_next) {
  wheels::WheelTrack track;
  for (double t : {0.0, 0.1, 0.19, 0.31, 0.4, 0.5}) {  // not quite even
    track.t.push_back(t);
    track.left.push_back(steadily(3.0, t));
    track.right.push_back(steadily(5.0, t));
    track.segment.push_back(0);
  }
  const DriveModel model(track, make_context(track, kBase));
  const Trajectory path = model.trajectory(as_span(to_vector(kBase)), {});
  const auto turned = [](double t) {
    return (steadily(5.0, t) * kBase.right_radius - steadily(3.0, t) * kBase.left_radius) / kBase.track_width;
  };
  for (double t = 0.1; t < 0.4; t += 0.013) EXPECT_NEAR(path.at(t).yaw, turned(t), 1e-12) << t;
  const double chord = turned(0.4) + 0.5 * (turned(0.5) - turned(0.4));
  EXPECT_NEAR(path.at(0.45).yaw, chord, 1e-12) << "after the last interval nothing is known";
}

TEST(WheelTrack, next_to_a_gap_or_another_segment_nothing_is_told_from_neighbours) {
  const auto bends = [](std::vector<double> t, std::vector<int> segment) {
    const wheels::WheelTrack track{std::move(t), {0, 1, 3, 6}, {0, 1, 3, 6}, std::move(segment)};
    return track.bend(1).after != 0.0 && track.bend(1).before != 0.0;
  };
  EXPECT_TRUE(bends({0.0, 0.1, 0.2, 0.3}, {0, 0, 0, 0}));
  EXPECT_FALSE(bends({0.0, 0.1, 0.2, 0.9}, {0, 0, 0, 0}));
  EXPECT_FALSE(bends({0.0, 0.7, 0.8, 0.9}, {0, 0, 0, 0}));
  EXPECT_FALSE(bends({0.0, 0.1, 0.2, 0.3}, {0, 0, 0, 1}));
  EXPECT_FALSE(bends({0.0, 0.1, 0.2, 0.3}, {0, 1, 1, 1}));
}

class JacobianOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(JacobianOf, agrees_with_central_differences) {
  const wheels::WheelTrack track = lively_track();
  const DriveModel model(track, make_context(track, kBase));
  EffectList effects;
  if (GetParam() > 0) effects.push_back(terms::effect_catalogue()[GetParam() - 1]);
  Eigen::VectorXd p = to_vector(kBase, count_parameters(effects));
  std::vector<double> steps(kBaseCount, 1e-6);
  for (const auto& effect : effects)
    for (const EffectParameter& parameter : effect->parameters()) {
      // Where a play lies between two that are known: at one of them the derivative has a step.
      const double typical = parameter.start != 0.0 ? parameter.start : 0.23 * parameter.scale;
      p(static_cast<Eigen::Index>(steps.size())) = typical;
      steps.push_back(4e-4 * typical);
    }
  const auto intervals = some_intervals();
  const Trajectory trajectory = model.trajectory(as_span(p), effects);
  const Eigen::MatrixXd jacobian = Sensitivity(model, trajectory, intervals).by_all();
  for (Eigen::Index k = 0; k < p.size(); ++k) {
    const double step = steps[static_cast<std::size_t>(k)];
    Eigen::VectorXd plus = p;
    Eigen::VectorXd minus = p;
    plus(k) += step;
    minus(k) -= step;
    const auto a = model.predict(as_span(plus), effects, intervals);
    const auto b = model.predict(as_span(minus), effects, intervals);
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double differences[] = {a[i].x - b[i].x, a[i].y - b[i].y, a[i].yaw - b[i].yaw};
      for (Eigen::Index r = 0; r < 3; ++r)
        worst = std::max(worst, std::abs(differences[r] / (2.0 * step) -
                                         jacobian(static_cast<Eigen::Index>(3 * i) + r, k)));
    }
    EXPECT_LT(worst, 1e-5 * std::max(1.0, jacobian.col(k).cwiseAbs().maxCoeff())) << "parameter " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Model, JacobianOf,
                         ::testing::Range(std::size_t{0}, terms::effect_catalogue().size() + 1),
                         [](const auto& tested) {
                           if (tested.param == 0) return std::string("base");
                           const auto& effect = terms::effect_catalogue()[tested.param - 1];
                           return effect->name() + "_" + effect->parameters().front().name;
                         });

TEST(Effects, change_nothing_where_their_fit_starts) {
  const wheels::WheelTrack track = lively_track();
  const DriveModel model(track, make_context(track, kBase));
  const auto intervals = some_intervals();
  const auto plain = model.predict(as_span(to_vector(kBase)), {}, intervals);
  for (const auto& effect : terms::effect_catalogue()) {
    const EffectList one = {effect};
    Eigen::VectorXd p = to_vector(kBase, count_parameters(one));
    const std::vector<double> start = start_of(one);
    std::copy(start.begin(), start.end(), p.data() + kBaseCount);
    const auto with = model.predict(as_span(p), one, intervals);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_NEAR(with[i].x, plain[i].x, 1e-12) << effect->name();
      EXPECT_NEAR(with[i].yaw, plain[i].yaw, 1e-12) << effect->name();
    }
  }
}

TEST(Context, speeds_and_accelerations_are_those_of_the_wheels) {
  const wheels::WheelTrack track = lively_track();
  const auto context = make_context(track, kBase);
  for (std::size_t k = 50; k < 1900; k += 37) {
    const double t = context[k].t;
    EXPECT_NEAR(context[k].left_speed, kBase.left_radius * (8.0 * 0.31 * std::cos(0.31 * t) + 0.7), 2e-3);
    EXPECT_NEAR(context[k].right_acceleration,
                -kBase.right_radius * 7.0 * 0.43 * 0.43 * std::sin(0.43 * t + 0.5), 2e-2);
  }
}

TEST(Backlash, is_that_of_the_plays_beside_it) {
  StepContext c;
  c.left_delta = 0.1;
  DriveHistory history(kBase, 0.0);
  for (const double delta : {-1.0, 0.1}) {  // it turns round
    c.left_delta = delta;
    history.advance(c);
  }
  const auto travel = [&](double play) {
    WheelStep<double> step{0.2, 0.0};
    terms::find_effect("backlash")->apply(c, std::array{play, 0.0, 0.0}, step);
    return step.left;
  };
  for (const double play : {0.0, 0.001, 0.004, 0.03, 0.09}) {
    EXPECT_NEAR(travel(play), 0.2 * (1.0 - play / 0.1), 1e-12) << play;
    EXPECT_NEAR(travel(-play), 0.2 * (1.0 + play / 0.1), 1e-12) << play;
  }
  EXPECT_NEAR(travel(0.3), 0.0, 1e-12);
}

TEST(WheelTrack, keeps_its_phase_where_a_signed_counter_of_32_bits_wraps) {
  Recording recording;
  recording.robot.ticks_per_rev = 1000.0;
  constexpr std::int64_t kLargest = 2147483647;
  recording.ticks = {{0.0, kLargest - 9, -5}, {1.0, kLargest - 4, 5}};
  const wheels::WheelTrack before = wheels::wheel_track_from_ticks(recording);
  recording.ticks = {{0.0, -kLargest - 1, 10}, {1.0, -kLargest + 9, 20}};  // five counts on
  const wheels::WheelTrack after = wheels::wheel_track_from_ticks(recording);
  const auto turns = [](double angle) { return std::remainder(angle, 2.0 * math::kPi); };
  EXPECT_NEAR(turns(after.left[0] - before.left[1]), 5.0 * before.tick_angle, 1e-9);
  EXPECT_NEAR(turns(after.right[0] - before.right[1]), 5.0 * before.tick_angle, 1e-9);
}

TEST(WheelTrack, SD_01_interpolates_with_the_weights_the_right_way_round) {
  wheels::WheelTrack track{{0.0, 1.0}, {0.0, 10.0}, {0.0, 0.0}, {0, 0}};
  const DriveModel model(track, make_context(track, kBase));
  const auto trajectory = model.trajectory(as_span(to_vector(wheels::BaseParameters{0.1, 0.1, 0.4, {}})), {});
  EXPECT_NEAR(trajectory.at(0.0).x, 0.0, 1e-12);
  EXPECT_LT(std::abs(trajectory.at(0.25).yaw), std::abs(trajectory.at(0.75).yaw));
}

TEST(WheelTrack, does_not_cover_a_change_of_segment) {
  wheels::WheelTrack track{{0.0, 1.0, 2.0, 3.0}, {0, 1, 2, 3}, {0, 1, 2, 3}, {0, 0, 1, 1}};
  EXPECT_TRUE(track.covers(0.1, 0.9));
  EXPECT_FALSE(track.covers(0.5, 2.5));
  EXPECT_TRUE(track.covers(2.1, 2.9));
  EXPECT_FALSE(track.covers(2.5, 3.5));
}

}  // namespace
}  // namespace odomcalib::calib::vehicle::model_test
