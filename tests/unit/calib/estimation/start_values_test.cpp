// Where the fit of the clocks starts, on motions made from the model.
#include "calib/estimation/start_values.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/terms/catalogue.hpp"
#include "calib/vehicle/step_context.hpp"

namespace odomcalib::calib::estimation::start_values_test {
namespace {

const wheels::BaseParameters kBase{0.075, 0.074, 0.4, {0.1, 0.02, 0.3}};
constexpr double kDuration = 240.0;  // s

/// Turns that change all the time, from `begin` on; before, the robot stands.
vehicle::DriveModel turning_from(double begin) {
  wheels::WheelTrack track;
  for (double t = 0.0; t <= kDuration; t += 0.02) {
    const double moved = std::max(0.0, t - begin);
    track.t.push_back(t);
    track.left.push_back(2.0 * std::sin(1.9 * moved) + moved);
    track.right.push_back(2.0 * std::sin(2.3 * moved) + moved);
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  return {std::move(track), context};
}

measurement::FitData measured(const vehicle::DriveModel& model, double delay, double rate) {
  const vehicle::EffectList clocks = {terms::find_effect("time_offset"), terms::find_effect("clock_drift")};
  Eigen::VectorXd p = vehicle::to_vector(kBase, vehicle::count_parameters(clocks));
  p(vehicle::kBaseCount) = delay;
  p(p.size() - 1) = rate;
  measurement::FitData data{&model, {}};
  std::vector<vehicle::Interval> intervals;
  for (double t = 1.0; t < kDuration - 1.0; t += 0.4) intervals.push_back({t, t + 0.4});
  const auto motions = model.predict({p.data(), static_cast<std::size_t>(p.size())}, clocks, intervals);
  for (std::size_t k = 0; k < intervals.size(); ++k)
    data.pairs.push_back({intervals[k], motions[k], Eigen::Matrix3d::Identity() * 1e-8, false});
  return data;
}

ClockStart found(double delay, double rate, double begin = 0.0) {
  const vehicle::DriveModel model = turning_from(begin);
  const measurement::FitData data = measured(model, delay, rate);
  return search_clock({&data, 1});
}

TEST(SearchClock, finds_a_delay_to_its_step) {
  EXPECT_EQ(found(0.0, 0.0).delay, 0.0);
  EXPECT_NEAR(found(0.2, 0.0).delay, 0.2, 0.011);
  EXPECT_NEAR(found(-0.13, 0.0).delay, -0.13, 0.011);
}

// Every tenth match of scans is wrong by as much as a match can be, always to one side.
TEST(SearchClock, finds_a_delay_beside_matches_that_are_wrong) {
  const vehicle::DriveModel model = turning_from(0.0);
  measurement::FitData data = measured(model, 0.2, 0.0);
  for (std::size_t k = 0; k < data.pairs.size(); k += 10) data.pairs[k].motion.yaw = 3.1;
  const ClockStart clock = search_clock({&data, 1});
  EXPECT_NEAR(clock.delay, 0.2, 0.011);
  EXPECT_EQ(clock.rate, 0.0);
}

TEST(SearchClock, finds_clocks_that_run_apart_by_a_thousandth) {
  for (const double rate : {-1e-3, 1e-3}) {
    const ClockStart clock = found(0.1, rate);
    EXPECT_NEAR(clock.delay, 0.1, 0.02);
    EXPECT_NEAR(clock.rate, rate, 0.2e-3);
  }
}

TEST(SearchClock, leaves_to_the_fit_what_it_can_find_itself_and_believes_no_half_that_says_nothing) {
  EXPECT_EQ(found(0.0, 1e-4).rate, 0.0);
  EXPECT_EQ(found(0.2, 0.0, 0.6 * kDuration).rate, 0.0) << "it stands in the first half";
  EXPECT_NEAR(found(0.2, 0.0, 0.6 * kDuration).delay, 0.2, 0.011);
}

}  // namespace
}  // namespace odomcalib::calib::estimation::start_values_test
