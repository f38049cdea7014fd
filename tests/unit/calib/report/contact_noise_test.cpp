#include "calib/report/contact_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "calib/solve.hpp"
#include "proto/calibration/report_data.hpp"
#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::report::contact_noise_test {
namespace {

TEST(ContactNoise, is_that_of_errors_that_were_not_fitted) {
  const Recording recording = test_support::driven_recording({0.1, 0.05, 0.2});
  const estimation::Fit fit = test_support::settled_fit({&recording, 1});
  const selection::FittedModel model{{}, fit.result};
  // The fit stays what it is: only what was held out is farther off.
  const auto noise_of = [&](double heading) {
    auto held_out = validation::held_out_errors(fit.dataset.data, {}, fit.result, fit.dataset.fixed());
    std::mt19937 engine(test_support::kDriveSeed);
    std::normal_distribution<double> error(0.0, heading);
    for (validation::HeldOutError& one : held_out) one.error(2) += error(engine);
    return contact_noise(fit.dataset, model, held_out).value_or(odometry::IncrementNoise{})[2];
  };
  EXPECT_NEAR(noise_of(2e-2) / noise_of(1e-2), 2.0, 0.1);
  EXPECT_LT(noise_of(0.0), 0.1 * noise_of(1e-2));
}

TEST(ContactNoise, is_none_without_a_trusted_pair) {
  const Recording recording = test_support::driven_recording({0.1, 0.05, 0.2});
  const estimation::Fit fit = test_support::settled_fit({&recording, 1});
  const auto held_out = validation::held_out_errors(fit.dataset.data, {}, fit.result, fit.dataset.fixed());
  selection::FittedModel model{{}, fit.result};
  EXPECT_TRUE(contact_noise(fit.dataset, model, held_out));
  std::fill(model.fit.weights.begin(), model.fit.weights.end(), 0.0);
  EXPECT_FALSE(contact_noise(fit.dataset, model, held_out));
}

TEST(ContactNoise, is_not_stated_where_nothing_was_held_out) {
  Recording recording = test_support::driven_recording({0.1, 0.05, 0.2});
  const auto solved = solve({&recording, 1}, {{"none"}});
  EXPECT_TRUE(odometry::contact_noise_of(solved));
  EXPECT_EQ(solved.verdict, Verdict::accepted);
  const auto beyond = [](const auto& sample) { return sample.t > 18.0; };  // a block is of 20 s
  std::erase_if(recording.ticks, beyond);
  std::erase_if(recording.poses, beyond);
  const auto of_one_block = solve({&recording, 1}, {{"none"}});
  EXPECT_FALSE(of_one_block.parameters.empty());
  EXPECT_FALSE(odometry::contact_noise_of(of_one_block));
  EXPECT_FALSE(of_one_block.residual.held_out);
  EXPECT_TRUE(report_data_of(of_one_block).drive_errors.empty());
  EXPECT_EQ(of_one_block.verdict, Verdict::accepted_with_warnings);
  ASSERT_FALSE(of_one_block.reasons.empty());
  EXPECT_NE(of_one_block.reasons.back().find("nothing of this drive was tested"), std::string::npos);
}

}  // namespace
}  // namespace odomcalib::calib::report::contact_noise_test
