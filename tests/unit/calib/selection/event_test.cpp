// Changes from one moment on: both wheels, the track, or where the sensor sits; and changes that fade.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "calib/selection/backward_elimination.hpp"
#include "calib/selection/file_entries.hpp"
#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/effects/step_effect.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::event_test {
namespace {

constexpr double kDuration = 240.0;  // s, of the drives

terms::SmoothTerm event_at(double moment, vehicle::Channel channel) {
  terms::SmoothTerm smooth{{vehicle::Covariate::time, channel}, 0.0, kDuration};
  smooth.basis = terms::ChangePoint{moment};
  return smooth;
}

double change_point_of(const terms::SmoothTerm& event) {
  return std::get<terms::ChangePoint>(event.basis).moment;
}

vehicle::StepContext at(double t) {
  vehicle::StepContext c;
  c.t = t;
  c.dt = 0.04;
  c.left_delta = 0.2;
  c.right_delta = 0.1;
  return c;
}

TEST(Event, of_the_wheels_has_one_size_for_each) {
  const terms::SmoothTerm smooth = event_at(100.0, vehicle::Channel::both_travel);
  const auto effect = make_smooth_term_effect(smooth);
  const std::vector<double> sizes = {0.01, -0.02};
  for (const double t : {99.0, 101.0}) {
    vehicle::WheelStep<double> step{1.0, 1.0};
    effect->apply(at(t), sizes, step);
    EXPECT_EQ(step.left, t < 100.0 ? 1.0 : 1.01);
    EXPECT_EQ(step.right, t < 100.0 ? 1.0 : 0.98);
  }
}

TEST(Event, of_the_wheels_about_its_mean_leaves_each_wheel_what_it_was_over_the_drive) {
  const vehicle::DriveModel model = lively_model();
  const std::vector<const vehicle::DriveModel*> models{&model};
  const terms::SmoothTerm smooth = as_of_the_drive(event_at(60.0, vehicle::Channel::both_travel), models);
  const auto effect = make_smooth_term_effect(smooth);
  double left = 0.0, right = 0.0, way = 0.0;
  for (const vehicle::StepContext& c : model.context()) {
    vehicle::WheelStep<double> step{c.left_delta, c.right_delta};
    effect->apply(c, std::vector{0.01, 0.0}, step);
    left += std::abs(step.left) - std::abs(c.left_delta);
    right += std::abs(step.right) - std::abs(c.right_delta);
    way += std::abs(c.left_delta);
  }
  EXPECT_NEAR(left / way, 0.0, 1e-12);
  EXPECT_EQ(right, 0.0) << "the other wheel's size is none of its";
}

/// Before the moment the sensor saw what it would have seen from its old place, to the second order in how
/// far it turned within an interval.
TEST(Event, of_the_sensor_is_another_mount_before_the_moment) {
  const vehicle::DriveModel model = lively_model();
  std::vector<vehicle::Interval> intervals;
  for (double t = 1.0; t < 100.0; t += 0.5) intervals.push_back({t, t + 0.5});
  const math::Pose moved{0.012, -0.02, 0.05};
  wheels::BaseParameters old = kBase;
  old.mount = compose({-moved.x, -moved.y, -moved.yaw}, kBase.mount);
  const auto seen = model.predict(vehicle::as_span(vehicle::to_vector(old)), {}, intervals);
  const vehicle::EffectList bump = {make_smooth_term_effect(event_at(150.0, vehicle::Channel::way_turned))};
  Eigen::VectorXd parameters = vehicle::to_vector(kBase, 3);
  parameters.tail<3>() << moved.x, moved.y, moved.yaw;
  const auto told = model.predict(vehicle::as_span(parameters), bump, intervals);
  const auto now = model.predict(vehicle::as_span(vehicle::to_vector(kBase)), {}, intervals);
  double farthest = 0.0;
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    EXPECT_NEAR(told[k].x, seen[k].x, 2e-4) << "at " << intervals[k].begin;
    EXPECT_NEAR(told[k].y, seen[k].y, 2e-4) << "at " << intervals[k].begin;
    EXPECT_NEAR(told[k].yaw, seen[k].yaw, 1e-9);
    farthest = std::max(farthest, std::hypot(now[k].x - seen[k].x, now[k].y - seen[k].y));
  }
  EXPECT_GT(farthest, 0.01) << "it does matter";
}

TEST(Event, is_sought_close_to_where_it_was_found) {
  const terms::SmoothTerm smooth = event_at(100.0, vehicle::Channel::track);
  const auto shapes = other_shapes(smooth, {});
  ASSERT_FALSE(shapes.empty());
  for (const terms::SmoothTerm& shape : shapes) {
    EXPECT_NE(change_point_of(shape), change_point_of(smooth));
    EXPECT_LT(std::abs(change_point_of(shape) - change_point_of(smooth)), kDuration / terms::kChangePoints);
  }
}

TEST(Event, and_what_fades_survive_the_calibration_file_on_time_alone) {
  terms::SmoothTerm fading{{vehicle::Covariate::time, vehicle::Channel::scale}, 0.0, kDuration};
  fading.basis = terms::Decay{40.0};
  const terms::SmoothTerm event = event_at(100.0, vehicle::Channel::both_travel);
  const auto read =
      terms::smooth_terms_of(terms::entries_of({{event, {0.01, -0.02}, ""}, {fading, {0.01}, ""}}));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].smooth, event);
  EXPECT_EQ(read[1].smooth, fading);
  terms::SmoothTerm nonsense = event;
  nonsense.dependence.covariate = vehicle::Covariate::speed;
  EXPECT_TRUE(terms::smooth_terms_of(terms::entries_of({{nonsense, {0.01, -0.02}, ""}})).empty());
}

TEST(Event, a_load_that_slips_is_found_with_its_moment) {
  const vehicle::DriveModel model = lively_model();
  const terms::SmoothTerm slip = event_at(131.0, vehicle::Channel::both_travel);
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(slip)}, {-0.008, 0.005}));
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  EXPECT_TRUE(result.findings.empty()) << "no drift";
  EXPECT_EQ(result.smooths[0].smooth.dependence, slip.dependence);
  EXPECT_NEAR(change_point_of(result.smooths[0].smooth), 131.0, 1.0);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount), -0.008, 4e-4);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kBaseCount + 1), 0.005, 4e-4);
}

TEST(Event, what_changes_bit_by_bit_keeps_its_name) {
  const vehicle::DriveModel model = lively_model();
  for (const double time_constant : {1e5, 40.0}) {
    const SearchResult result =
        searched(measured(model, {terms::find_effect("drift_with_time")}, {0.004, 0.002, time_constant}));
    ASSERT_EQ(result.findings.size(), 1U) << time_constant << " s, seed " << kSeed;
    EXPECT_EQ(result.findings[0].effect->name(), "drift_with_time");
    EXPECT_FALSE(result.has_unnamed());
  }
}

TEST(Event, a_lidar_that_was_knocked_is_where_it_is_now) {
  const vehicle::DriveModel model = lively_model();
  const terms::SmoothTerm bump = event_at(87.0, vehicle::Channel::way_turned);
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(bump)}, {0.012, -0.005, 0.04}));
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  EXPECT_TRUE(is_bump(result.smooths[0].smooth));
  EXPECT_NEAR(change_point_of(result.smooths[0].smooth), 87.0, 1.0);
  EXPECT_EQ(result.smooths[0].effect->storage(), vehicle::Storage::driver) << "wheels do not crab";
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kMountX), kBase.mount.x, 5e-4);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kMountYaw), kBase.mount.yaw, 5e-4);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kLeftRadius), kBase.left_radius, 5e-5);
}

TEST(Event, a_lidar_that_warms_up_leaves_the_lengths_of_a_warm_one) {
  const vehicle::DriveModel model = lively_model();
  terms::SmoothTerm warming{{vehicle::Covariate::time, vehicle::Channel::scale}, 0.0, kDuration};
  warming.basis = terms::Decay{45.0};
  const SearchResult result = searched(measured(model, {make_smooth_term_effect(warming)}, {0.01}));
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  EXPECT_EQ(result.smooths[0].smooth.dependence, warming.dependence);
  EXPECT_NEAR(std::get<terms::Decay>(result.smooths[0].smooth.basis).time_constant, 45.0, 15.0);
  EXPECT_NEAR(result.model.fit.parameters(vehicle::kTrackWidth), kBase.track_width, 5e-4);
}

TEST(EventText, says_what_changed_when_and_for_which_state_the_values_stand) {
  const terms::FittedSmoothTerm slip{event_at(121.75, vehicle::Channel::both_travel), {-0.0109, 0.0042}, ""};
  EXPECT_NE(
      event_to_text(slip, {}).find("121.8 s after the beginning the wheels changed at once (left -1.09 %, "
                                   "right +0.42 %)"),
      std::string::npos)
      << event_to_text(slip, {});
  // Turned to the left about itself, a quarter of a metre ahead of the axle, and moved 12 mm ahead.
  const math::Pose mount{0.25, 0.0, 0.05};
  const math::Pose before = compose({-0.01, -0.005, -0.05}, mount);
  const terms::FittedSmoothTerm knock{event_at(60.0, vehicle::Channel::way_turned), {0.01, 0.005, 0.05}, ""};
  std::ostringstream place;
  place << std::showpos << std::fixed << std::setprecision(1) << "x " << 1e3 * (mount.x - before.x)
        << " mm, y " << 1e3 * (mount.y - before.y) << " mm, yaw +2.86 deg";
  EXPECT_NE(event_to_text(knock, mount).find(place.str()), std::string::npos) << event_to_text(knock, mount);
  const terms::FittedSmoothTerm patch{event_at(60.0, vehicle::Channel::track), {0.01}, ""};
  EXPECT_NE(event_to_text(patch, {}).find("track width changed at once (+1.00 %)"), std::string::npos);
}

/// The left wheel drags in one kind of motion alone: backwards and to the left.
class Drag final : public terms::StepEffect<Drag> {
 public:
  Drag()
      : StepEffect(
            {.name = "drag",
             .parameters = {{.name = "share", .unit = "1", .scale = 0.05, .lower = -1.0, .upper = 1.0}}}) {}

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    if (c.speed < -0.05 && c.turn_rate > 0.1) step.left *= 1.0 + p[0];
  }
};

TEST(UnhelpfulSmooths, are_those_that_leave_more_than_half_of_the_error) {
  const vehicle::DriveModel model = lively_model();
  const auto drag = std::make_shared<Drag>();
  measurement::FitData data = measured(model, {drag}, {0.02});
  for (std::size_t k = 1; k < data.pairs.size(); ++k) data.pairs[k].follows_previous = true;
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  const auto fitted = [&](const vehicle::EffectList& effects) {
    const auto fit = task.fit(effects, vehicle::to_vector(kBase, vehicle::count_parameters(effects)), {});
    EXPECT_TRUE(fit) << "seed " << kSeed;
    return FittedModel{effects, *fit};
  };
  const terms::SmoothTerm of_time{{vehicle::Covariate::time, vehicle::Channel::left_travel}, 0.0, kDuration};
  const FittedModel plain = fitted({});
  EXPECT_FALSE(explain_too_little(task, fitted({drag}), plain));
  EXPECT_TRUE(explain_too_little(task, fitted({make_smooth_term_effect(of_time)}), plain));
  EXPECT_TRUE(explain_too_little(task, plain, plain));
}

}  // namespace
}  // namespace odomcalib::calib::selection::event_test
