// The odd one of several recordings, and what it differs in, by estimates whose truth is known.
#include "calib/report/odd_recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::report::odd_recording_test {
namespace {

using vehicle::kLeftRadius, vehicle::kMountX, vehicle::kRightRadius, vehicle::kTrackWidth;

const std::vector<Eigen::Index> kAll = {0, 1, 2, 3, 4, 5};
const std::vector<std::string> kNames = {"a", "b", "c", "d", "e"};

Eigen::VectorXd truth() {
  Eigen::VectorXd value(6);
  value << 0.0765, 0.0772, 0.394, 0.09, -0.015, -0.04;
  return value;
}

/// Without noise. Turns alone tell ratios of lengths to 2e-5, and their scale badly.
/// @param scale relative deviation of all lengths together
math::OwnValues estimate(std::size_t recording, double scale, Eigen::VectorXd value = truth()) {
  Eigen::VectorXd lengths = truth(), deviations(6);
  lengths.tail(3).setZero();
  deviations << 1.5e-6, 1.5e-6, 8e-6, 1.5e-4, 1.5e-4, 4e-4;
  Eigen::MatrixXd covariance = deviations.cwiseAbs2().asDiagonal();
  covariance += scale * scale * lengths * lengths.transpose();
  return {recording, std::move(value), std::move(covariance), 300.0};
}

Eigen::VectorXd with(Eigen::Index parameter, double factor) {
  Eigen::VectorXd value = truth();
  value(parameter) *= factor;
  return value;
}

std::vector<Eigen::Index> parameters_of(const std::vector<ParameterChange>& changes) {
  std::vector<Eigen::Index> all(changes.size());
  std::transform(changes.begin(), changes.end(), all.begin(),
                 [](const ParameterChange& change) { return change.parameter; });
  std::sort(all.begin(), all.end());
  return all;
}

using Numbers = std::vector<std::size_t>;
using Parameters = std::vector<Eigen::Index>;

// The pool of the others holds the odd one, and takes its ratios for true.
TEST(OddRecording, that_knows_ratios_best_is_named_and_not_one_of_the_others) {
  const OddRecordings found = odd_recordings(
      {estimate(0, 5e-4), estimate(1, 2.4e-3, with(kLeftRadius, 1.015)), estimate(2, 3e-4)}, kAll, kNames);
  EXPECT_TRUE(found.is_decided);
  EXPECT_EQ(found.odd, Numbers{1});
  EXPECT_EQ(found.others, (Numbers{0, 2}));
  EXPECT_EQ(parameters_of(found.changes), Parameters{kLeftRadius});
  EXPECT_NEAR(found.changes.front().difference, 0.015 * truth()(kLeftRadius), 1e-8);
  EXPECT_GT(found.changes.front().sigmas, 100.0);
}

TEST(OddRecording, with_other_tyres_on_both_wheels_is_said_to_have_both) {
  Eigen::VectorXd value = truth();
  value.head(2) *= 1.01;
  const OddRecordings found =
      odd_recordings({estimate(0, 5e-4), estimate(1, 1e-3, value), estimate(2, 3e-4)}, kAll, kNames);
  EXPECT_EQ(found.odd, Numbers{1});
  EXPECT_EQ(parameters_of(found.changes), (Parameters{kLeftRadius, kRightRadius}));
  EXPECT_NEAR(found.changes.front().difference / truth()(found.changes.front().parameter), 0.01, 1e-6);
}

// Where neither knows its scale, larger wheels and a smaller track look the same.
TEST(OddRecording, says_what_explains_it_as_well) {
  Eigen::VectorXd value = truth();
  value.head(2) *= 1.01;
  const OddRecordings found =
      odd_recordings({estimate(0, 1e-2), estimate(1, 1e-2, value), estimate(2, 1e-2)}, kAll, kNames);
  std::vector<Parameters> both = {parameters_of(found.changes), parameters_of(found.as_well)};
  std::sort(both.begin(), both.end());
  EXPECT_EQ(both, (std::vector<Parameters>{{kLeftRadius, kRightRadius}, {kTrackWidth}}));
}

TEST(OddRecording, of_two_is_undecided_whatever_their_order) {
  const OddRecordings found =
      odd_recordings({estimate(0, 5e-4), estimate(1, 5e-4, with(kTrackWidth, 1.01))}, kAll, kNames);
  const OddRecordings turned =
      odd_recordings({estimate(1, 5e-4, with(kTrackWidth, 1.01)), estimate(0, 5e-4)}, kAll, kNames);
  for (const OddRecordings& one : {found, turned}) {
    EXPECT_FALSE(one.is_decided);
    EXPECT_EQ(one.odd, Numbers{1});
    EXPECT_EQ(one.others, Numbers{0});
    EXPECT_EQ(parameters_of(one.changes), Parameters{kTrackWidth});
    EXPECT_GT(one.changes.front().difference, 0.0);
  }
}

TEST(OddRecording, of_two_against_two_is_undecided_and_of_two_against_three_is_not) {
  std::vector<math::OwnValues> all;
  for (std::size_t k = 0; k < 4; ++k)
    all.push_back(estimate(k, 5e-4, with(kLeftRadius, k % 2 == 1 ? 1.005 : 1.0)));
  const OddRecordings even = odd_recordings(all, kAll, kNames);
  EXPECT_FALSE(even.is_decided);
  EXPECT_EQ(even.odd, (Numbers{1, 3}));
  EXPECT_EQ(even.others, (Numbers{0, 2}));
  EXPECT_TRUE(even.neither.empty());
  all.push_back(estimate(4, 5e-4));
  const OddRecordings odd = odd_recordings(all, kAll, kNames);
  EXPECT_TRUE(odd.is_decided);
  EXPECT_EQ(odd.odd, (Numbers{1, 3}));
  EXPECT_EQ(parameters_of(odd.changes), Parameters{kLeftRadius});
}

TEST(OddRecording, of_three_that_all_differ_is_undecided) {
  const OddRecordings found = odd_recordings({estimate(0, 5e-4), estimate(1, 5e-4, with(kLeftRadius, 1.005)),
                                              estimate(2, 5e-4, with(kTrackWidth, 1.02))},
                                             kAll, kNames);
  EXPECT_FALSE(found.is_decided);
  EXPECT_EQ(found.odd.size() + found.others.size(), 2U);
  EXPECT_EQ(found.neither.size(), 1U);
}

// A recording that knows little agrees with both of two that differ.
TEST(OddRecording, is_not_decided_by_one_that_agrees_with_both) {
  math::OwnValues vague = estimate(2, 5e-4);
  vague.covariance *= 1e6;
  const OddRecordings found =
      odd_recordings({estimate(0, 5e-4), estimate(1, 5e-4, with(kLeftRadius, 1.005)), vague}, kAll, kNames);
  EXPECT_FALSE(found.is_decided);
  EXPECT_EQ(parameters_of(found.changes), Parameters{kLeftRadius});
}

// Deviations of one recording alone are never quite right.
TEST(OddRecording, is_not_said_to_differ_in_what_hardly_explains_anything) {
  Eigen::VectorXd value = with(kLeftRadius, 1.015);
  value(kMountX) += 1e-3;  // m, 6 deviations
  const OddRecordings found =
      odd_recordings({estimate(0, 5e-4), estimate(1, 5e-4, value), estimate(2, 5e-4)}, kAll, kNames);
  EXPECT_EQ(parameters_of(found.changes), Parameters{kLeftRadius});
  value(kMountX) += 0.1;
  EXPECT_EQ(parameters_of(
                odd_recordings({estimate(0, 5e-4), estimate(1, 5e-4, value), estimate(2, 5e-4)}, kAll, kNames)
                    .changes),
            (Parameters{kLeftRadius, kMountX}));
}

}  // namespace
}  // namespace odomcalib::calib::report::odd_recording_test
