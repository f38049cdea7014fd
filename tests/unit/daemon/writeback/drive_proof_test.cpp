// Drives that prove values that wait to be stored, and drives that do not.
#include "daemon/writeback/drive_proof.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

namespace odomcalib::drive_proof_test {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;

constexpr double kTurn = 2.0 * std::numbers::pi;

ordered_json motion(double distance, double yaw, double distance_error, double yaw_error) {
  return {
      {"moves",
       {{{"lidar", {distance, 0.0, yaw}}, {"error", {{"distance", distance_error}, {"yaw", yaw_error}}}}}}};
}
ordered_json straight(double error) { return motion(1.0, 0.0, error, 0.0); }
ordered_json spin(double error) { return motion(0.0, kTurn, 0.0, error); }

/// Driven with the old values, off by so much, and then with the new ones.
DriveProof driven(double before, double after) {
  DriveProof proof;
  proof.driven(straight(before));
  proof.driven(spin(before));
  proof.other_values();
  proof.driven(straight(after));
  proof.driven(spin(after));
  return proof;
}

std::string lacking(const DriveProof& proof) { return proof.lacking() ? proof.lacking()->what : ""; }

TEST(DriveProof, is_there_when_odometry_is_no_worse_than_before) {
  EXPECT_EQ(lacking(driven(0.02, 0.01)), "");
  EXPECT_EQ(lacking(driven(0.02, 0.02)), "");
  EXPECT_THAT(lacking(driven(0.02, 0.0201)), HasSubstr("with the new values"));
}

// 2 mm over a metre and 0.1 degrees are what the comparison cannot tell.
TEST(DriveProof, what_no_comparison_can_tell_is_not_worse) {
  EXPECT_FALSE(worse({0.0, 0.0, 0.0}, {0.0019, 0.0017, 0.0017}));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0021, 0.0, 0.0}).value_or(""), HasSubstr("length"));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0, 0.0018, 0.0}).value_or(""), HasSubstr("straight metre: heading"));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0018}).value_or(""), HasSubstr("full turn"));
}

TEST(DriveProof, needs_a_straight_and_a_turn_before_and_after) {
  for (int left_out = 0; left_out < 4; ++left_out) {
    DriveProof proof;
    if (left_out != 0) proof.driven(straight(0.02));
    if (left_out != 1) proof.driven(spin(0.02));
    proof.other_values();
    if (left_out != 2) proof.driven(straight(0.01));
    if (left_out != 3) proof.driven(spin(0.01));
    EXPECT_THAT(lacking(proof), HasSubstr(left_out < 2 ? "with the old values was not" : "were driven"));
  }
  EXPECT_TRUE(DriveProof().lacking());
}

TEST(DriveProof, tells_what_was_driven_for_the_values_that_wait) {
  const DriveTrial trial = driven(0.02, 0.01).trial();
  ASSERT_TRUE(trial.before && trial.after);
  EXPECT_NEAR(trial.before->straight_metre_length, 0.02, 1e-12);
  EXPECT_NEAR(trial.after->straight_metre_length, 0.01, 1e-12);
  DriveProof none;
  none.driven(straight(0.02));
  none.driven(spin(0.02));
  EXPECT_TRUE(none.trial().is_empty()) << "nothing waits";
  none.other_values();
  EXPECT_TRUE(none.trial().before && !none.trial().after);
}

TEST(DriveProof, what_the_lidar_did_not_see_whole_is_none) {
  DriveProof proof = driven(0.02, 0.01);
  ordered_json unseen = straight(0.5);
  unseen["moves"].push_back(unseen["moves"][0]);
  unseen["moves"][1]["error"] = nullptr;
  proof.driven(unseen);
  EXPECT_EQ(lacking(proof), "") << "it changes nothing";
  DrivenErrors errors;
  EXPECT_FALSE(errors.add(unseen));
  EXPECT_FALSE(errors.add({{"moves", ordered_json::array()}}));
  EXPECT_FALSE(errors.add(ordered_json::object()));
}

// 0.45 m and 162 degrees.
TEST(DriveProof, too_short_a_move_is_none) {
  DrivenErrors errors;
  EXPECT_FALSE(errors.add(motion(0.449, 0.0, 0.0, 0.0)));
  EXPECT_FALSE(errors.add(motion(0.0, 2.82, 0.0, 0.0)));
  EXPECT_TRUE(errors.add(motion(0.451, 0.0, 0.0, 0.0)));
  EXPECT_FALSE(errors.all());
  EXPECT_TRUE(errors.add(motion(0.0, -2.83, 0.0, 0.0)));
  EXPECT_TRUE(errors.all());
}

TEST(DriveProof, belongs_to_the_values_that_were_driven_with) {
  DriveProof proof = driven(0.02, 0.01);
  proof.taken_back();
  proof.other_values();
  EXPECT_THAT(lacking(proof), HasSubstr("were driven")) << "other values wait now";
  proof.driven(straight(0.015));
  proof.driven(spin(0.015));
  EXPECT_EQ(lacking(proof), "") << "what the old ones were off by is still known";
  proof.committed();
  proof.other_values();
  proof.driven(straight(0.016));
  proof.driven(spin(0.015));
  EXPECT_THAT(lacking(proof), HasSubstr("with the new values, by"));
}

TEST(DriveProof, what_was_stored_without_one_was_not_driven_with) {
  DriveProof proof;
  proof.driven(straight(0.5));
  proof.driven(spin(0.5));
  proof.committed();
  proof.other_values();
  proof.driven(straight(0.01));
  proof.driven(spin(0.01));
  EXPECT_THAT(lacking(proof), HasSubstr("with the old values was not"));
}

TEST(DriveProof, is_forgotten_when_nobody_knows_what_is_in_force) {
  DriveProof proof = driven(0.02, 0.01);
  proof.forget();
  EXPECT_TRUE(proof.lacking());
}

}  // namespace
}  // namespace odomcalib::drive_proof_test
