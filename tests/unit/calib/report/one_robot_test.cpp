// Messages about recordings that do not agree on one robot: in which quantity, by how much.
#include "calib/report/one_robot.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::report::one_robot_test {
namespace {

std::vector<Recording> named_recordings() {
  std::vector<Recording> all(2);
  all[0].name = "a.jsonl";
  all[1].name = "b.jsonl";
  return all;
}

/// Two recordings of a robot with wheels of 0.15 m, of which the second differs in one parameter.
report::Homogeneity that_differ(Eigen::Index parameter, double difference, double sigmas) {
  report::OwnEstimate own{Eigen::VectorXd(6), Eigen::MatrixXd::Identity(6, 6) * 1e-8, 100.0};
  own.value << 0.075, 0.075, 0.4, 0.1, 0.0, 0.0;
  report::Homogeneity found;
  found.own = {own, own};
  found.sigmas = found.differences = Eigen::MatrixXd::Zero(2, 6);
  found.sigmas(1, parameter) = sigmas;
  found.differences(1, parameter) = difference;
  found.p_value = 1e-6;
  found.recording = 1;
  found.parameter = parameter;
  found.odd = OddRecordings{{1}, {0}, false, {}, {{parameter, difference, sigmas}}, {}};
  return found;
}

std::string said(Eigen::Index parameter, double difference) {
  const auto apart = recordings_apart(that_differ(parameter, difference, 10.0), named_recordings());
  return apart ? apart->reason : "";
}

TEST(RecordingsApart, are_told_in_the_unit_of_what_differs) {
  using vehicle::kMountX, vehicle::kMountYaw, vehicle::kTrackWidth;
  EXPECT_NE(said(0, 7.5e-4).find("is 1 % (1.5 mm) larger"), std::string::npos) << said(0, 7.5e-4);
  EXPECT_NE(said(kTrackWidth, -4e-3).find("is 1 % (4 mm) smaller"), std::string::npos)
      << said(kTrackWidth, -4e-3);
  EXPECT_NE(said(kMountX, 3e-3).find("is 3 mm larger"), std::string::npos) << said(kMountX, 3e-3);
  EXPECT_NE(said(kMountYaw, 0.0174533).find("is 1 degrees larger"), std::string::npos)
      << said(kMountYaw, 0.0174533);
}

TEST(RecordingsApart, of_two_are_both_named_and_neither_is_blamed) {
  const std::string text = said(0, 7.5e-4);
  EXPECT_NE(text.find("larger in b.jsonl than in a.jsonl"), std::string::npos) << text;
  EXPECT_NE(text.find("which of them changed they do not tell"), std::string::npos) << text;
}

TEST(RecordingsApart, say_all_that_changed_and_what_explains_it_as_well) {
  std::vector<Recording> recordings = named_recordings();
  recordings.resize(4);
  recordings[2].name = "c.jsonl", recordings[3].name = "d.jsonl";
  auto found = that_differ(0, 7.5e-4, 10.0);
  found.own.resize(4, found.own[0]);
  found.odd = OddRecordings{{1}, {0, 2}, true, {3}, {{0, 7.5e-4, 10.0}, {1, 7.5e-4, 9.0}}, {{2, -4e-3, 8.0}}};
  const auto apart = recordings_apart(found, recordings);
  ASSERT_TRUE(apart);
  EXPECT_NE(apart->reason.find(
                "in b.jsonl left_wheel_diameter is 1 % (1.5 mm) larger and right_wheel_diameter "
                "is 1 % (1.5 mm) larger than in the others, 10 deviations; it may as well be that "
                "track_width is 1 % (4 mm) smaller there, 8 deviations; d.jsonl agrees with neither"),
            std::string::npos)
      << apart->reason;
}

/// Each alone stays below the bound, and its deviations hide it; together they are no chance.
TEST(RecordingsApart, beyond_the_bound_by_what_explains_them_are_refused) {
  auto found = that_differ(0, 1e-6, 1.0);
  found.odd->changes = {{0, 1.01 * 0.005 * 0.075, 10.0}};
  EXPECT_TRUE(recordings_apart(found, named_recordings())->refuses);
  found.odd->changes = {{0, 0.99 * 0.005 * 0.075, 10.0}};
  EXPECT_FALSE(recordings_apart(found, named_recordings())->refuses);
}

TEST(RecordingsApart, beyond_a_bound_of_each_kind_are_refused) {
  struct Case {
    Eigen::Index parameter;
    double bound;
  };
  for (const Case& one : {Case{vehicle::kMountX, 0.01}, Case{vehicle::kMountYaw, 0.02}})
    for (const double sign : {-1.0, 1.0}) {
      const auto near =
          recordings_apart(that_differ(one.parameter, 0.99 * sign * one.bound, 10.0), named_recordings());
      const auto far =
          recordings_apart(that_differ(one.parameter, 1.01 * sign * one.bound, 10.0), named_recordings());
      const auto chance =
          recordings_apart(that_differ(one.parameter, 1.01 * sign * one.bound, 3.9), named_recordings());
      ASSERT_TRUE(near && far && chance);
      EXPECT_FALSE(near->refuses) << one.parameter;
      EXPECT_TRUE(far->refuses) << one.parameter;
      EXPECT_FALSE(chance->refuses) << one.parameter;
    }
}

TEST(StoredHomogeneity, has_what_each_recording_determines) {
  auto found = that_differ(0, 7.5e-4, 10.0);
  found.own[1]->covariance(5, 5) = 0.0;
  Calibration calibration;
  store_homogeneity(found, named_recordings(), calibration);
  const auto& all = calibration.recordings;
  ASSERT_EQ(all.size(), found.own.size());
  const std::map first(all[0].parameters->begin(), all[0].parameters->end());
  const std::map second(all[1].parameters->begin(), all[1].parameters->end());
  EXPECT_TRUE(first.contains("lidar_yaw"));
  EXPECT_FALSE(second.contains("lidar_yaw")) << "it was fixed";
  EXPECT_NEAR(second.at("left_wheel_diameter").value, 0.15, 1e-12);
  EXPECT_NEAR(second.at("left_wheel_diameter").std, 2e-4, 1e-12);
  EXPECT_NEAR(second.at("track_width").std, 1e-4, 1e-12);
  EXPECT_EQ(all[1].deviation[0], (std::pair<std::string, double>("left_wheel_diameter", 10.0)));
  EXPECT_EQ(calibration.homogeneity->worst.recording, "b.jsonl");
}

}  // namespace
}  // namespace odomcalib::calib::report::one_robot_test
