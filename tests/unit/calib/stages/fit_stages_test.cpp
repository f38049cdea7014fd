// Stages that may hand on another fit, or the one they were given.

#include <gtest/gtest.h>

#include "calib/stages/fit_stages.hpp"
#include "calib/stages/lidar_correction.hpp"
#include "calib/stages/placed_fit.hpp"
#include "calib/terms/catalogue.hpp"
#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::stages::fit_stages_test {
namespace {

using odomcalib::test_support::driven_recording;
using odomcalib::test_support::rough_dataset;
using odomcalib::test_support::settled_fit;
using odomcalib::test_support::silent_settling;
using vehicle::ClockPart;

TEST(MountReference, a_marker_beside_the_axle_gets_its_place) {
  const Recording recording = driven_recording({0.12, 0.04, 0.0});
  const estimation::Fit fit = mount_reference(settled_fit({&recording, 1}), silent_settling());
  ASSERT_FALSE(fit.failure) << fit.failure->text();
  EXPECT_TRUE(fit.dataset.reference_sits_anywhere);
  EXPECT_NEAR(fit.model.parameters(vehicle::kMountX), 0.12, 3e-3);
  EXPECT_NEAR(fit.model.parameters(vehicle::kMountY), 0.04, 3e-3);
}

TEST(MountReference, a_marker_over_the_axle_is_the_base) {
  const Recording recording = driven_recording({});
  const estimation::Fit fit = mount_reference(settled_fit({&recording, 1}), silent_settling());
  ASSERT_FALSE(fit.failure) << fit.failure->text();
  EXPECT_FALSE(fit.dataset.reference_sits_anywhere);
  EXPECT_EQ(fit.model.parameters(vehicle::kMountX), 0.0);
}

struct Known {
  double value = 0.0, deviation = 0.0;
};

/// As if fitted with both parts of the clock.
estimation::Fit fit_with_clocks(const Known& offset, const Known& rate) {
  estimation::Fit fit;
  fit.model.effects = {terms::clock_effect(ClockPart::offset), terms::clock_effect(ClockPart::rate)};
  const auto count = first_parameter(fit.model.effects, 2);
  fit.model.parameters = Eigen::VectorXd::Zero(count);
  fit.result.covariance = Eigen::MatrixXd::Zero(count, count);
  const auto state = [&](ClockPart part, const Known& known) {
    const Eigen::Index k = *parameter_of(fit.model.effects, part);
    fit.model.parameters(k) = known.value;
    fit.result.covariance(k, k) = known.deviation * known.deviation;
  };
  state(ClockPart::offset, offset);
  state(ClockPart::rate, rate);
  fit.result.parameters = fit.model.parameters;
  return fit;
}

TEST(Clocks, leave_where_they_are_idle) {
  const auto left = [](const Known& offset, const Known& rate) {
    return without_idle_clocks(fit_with_clocks(offset, rate)).effects.size();
  };
  EXPECT_EQ(left({0.05, 1e-3}, {1e-4, 1e-5}), 2U);
  EXPECT_EQ(left({0.05, 1e-3}, {1e-5, 1e-5}), 1U) << "the rate leaves";
  EXPECT_EQ(left({0.002, 1e-5}, {1e-5, 1e-5}), 0U) << "plain, but too short to matter";
  EXPECT_EQ(left({0.0, 1e-3}, {1e-4, 1e-5}), 2U) << "clocks that run apart need an offset";
}

TEST(Clocks, leave_with_their_parameters) {
  const estimation::Fit fit = fit_with_clocks({0.05, 1e-3}, {0.0, 1e-5});
  const vehicle::VehicleModel model = without_idle_clocks(fit);
  EXPECT_EQ(model.parameters.size(), first_parameter(fit.model.effects, 1));
  EXPECT_EQ(delay_of(model), 0.05);
}

TEST(FitStages, hand_on_a_fit_that_failed) {
  const Recording recording = driven_recording({}, 0.0);
  const measurement::Dataset rough = rough_dataset({&recording, 1});
  const vehicle::VehicleModel start{{}, vehicle::to_vector(rough.nominal)};
  const estimation::Fit failed = settle(rough, start, silent_settling());
  ASSERT_TRUE(failed.failure) << "straight ahead nothing tells the track width";
  const terms::Request request;
  EXPECT_TRUE(mount_reference(failed, silent_settling()).failure);
  EXPECT_TRUE(choose_scan_stamps(failed, silent_settling()).failure);
  EXPECT_TRUE(choose_sweep_timing(failed, request, silent_settling()).failure);
  EXPECT_TRUE(correct_lidar(failed, request, silent_settling()).fit.failure);
  EXPECT_TRUE(placement_of(failed, {}, silent_settling().progress).paths.empty());
  EXPECT_TRUE(locate(failed, {}).failure);
}

TEST(FitStages, that_do_not_apply_hand_on_the_fit_as_it_is) {
  const Recording recording = driven_recording({});
  const estimation::Fit fit = settled_fit({&recording, 1});
  const estimation::Fit after =
      choose_sweep_timing(choose_scan_stamps(fit, silent_settling()), {}, silent_settling());
  EXPECT_EQ(after.model.parameters, fit.model.parameters);
  EXPECT_TRUE(after.dataset.recordings.are_those_of(fit.dataset.recordings));
}

}  // namespace
}  // namespace odomcalib::calib::stages::fit_stages_test
