// Fits as values.
#include "calib/estimation/fit.hpp"

#include <gtest/gtest.h>

#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::estimation::fit_test {
namespace {

using odomcalib::test_support::driven_recording;
using odomcalib::test_support::rough_dataset;
using odomcalib::test_support::settled_fit;
using odomcalib::test_support::silent_settling;

TEST(Fit, settles_on_the_truth_without_a_clock_that_is_idle) {
  const Recording recording = driven_recording({});
  const Fit fit = settled_fit({&recording, 1});
  ASSERT_FALSE(fit.failure) << fit.failure->text();
  EXPECT_TRUE(fit.model.effects.empty());
  EXPECT_EQ(fit.model.parameters, fit.result.parameters);
  EXPECT_NEAR(fit.model.parameters(vehicle::kLeftRadius), test_support::kLeftRadius, 5e-5);
  EXPECT_NEAR(fit.model.parameters(vehicle::kTrackWidth), test_support::kTrackWidth, 1e-3);
}

TEST(Fit, settles_with_a_clock_that_is_late) {
  Recording recording = driven_recording({});
  for (PoseSample& pose : recording.poses) pose.t += 0.05;
  const Fit fit = settled_fit({&recording, 1});
  ASSERT_FALSE(fit.failure) << fit.failure->text();
  ASSERT_EQ(fit.model.effects.size(), 1U);
  EXPECT_NEAR(delay_of(fit.model), 0.05, 1e-3);
}

TEST(Fit, that_fails_says_why_and_keeps_its_pairs) {
  const Recording recording = driven_recording({}, 0.0);
  const measurement::Dataset rough = rough_dataset({&recording, 1});
  const vehicle::VehicleModel start{{}, vehicle::to_vector(rough.nominal)};
  const Fit fit = settle(rough, start, silent_settling());
  ASSERT_TRUE(fit.failure) << "straight ahead nothing tells the track width";
  EXPECT_NE(fit.failure->what.find("track width"), std::string::npos) << fit.failure->what;
  EXPECT_FALSE(fit.dataset.data.front().pairs.empty());
  EXPECT_EQ(fit.model.parameters, start.parameters);
}

}  // namespace
}  // namespace odomcalib::calib::estimation::fit_test
