#include "calib/report/gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "calib/math/se2.hpp"
#include "calib/report/settings.hpp"
#include "calib/report/verdict_rules.hpp"

namespace odomcalib::calib::report::gate_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// All as it should be.
Calibration sound() {
  Calibration calibration;
  calibration.robot.left_wheel_diameter = calibration.robot.right_wheel_diameter = 0.15;
  calibration.robot.track_width = 0.4;
  calibration.parameters = {{"left_wheel_diameter", {0.151, 1e-4, "m"}},
                            {"right_wheel_diameter", {0.149, 1e-4, "m"}},
                            {"track_width", {0.41, 2e-4, "m"}},
                            {"lidar_x", {0.1, 0.5, "m"}}};
  return calibration;
}

Calibration with_track(double value, double deviation) {
  Calibration calibration = sound();
  calibration.parameters[2].second = {value, deviation, "m"};
  return calibration;
}

const VerdictEvidence kFirm{true, 400, 20, {}};

TEST(Gate, accepts_what_is_sound_and_leaves_the_lidar_pose_alone) {
  const GateResult gate = judge(sound(), kFirm);
  EXPECT_EQ(gate.verdict, Verdict::accepted);
  EXPECT_TRUE(gate.reasons.empty());
}

TEST(Gate, refuses_a_badly_determined_length_and_names_the_motion_for_it) {
  EXPECT_EQ(judge(with_track(0.4, 0.0019), kFirm).verdict, Verdict::accepted);
  EXPECT_EQ(judge(with_track(0.4, 0.0021), kFirm).verdict, Verdict::accepted_with_warnings);
  const GateResult gate = judge(with_track(0.4, 0.0121), kFirm);
  EXPECT_EQ(gate.verdict, Verdict::refused);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("turns on the spot"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, asks_for_the_motion_that_is_missing_not_for_what_was_driven) {
  VerdictEvidence evidence = kFirm;
  evidence.missing_motion = "straight lines, forward and backward";
  const GateResult gate = judge(with_track(0.4, 0.0121), evidence);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("record straight lines"), std::string::npos) << gate.reasons[0];
  EXPECT_EQ(gate.reasons[0].find("turns on the spot"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, of_a_length_that_is_not_determined_the_value_says_nothing) {
  for (const double track : {-20.0, 0.05}) {
    const GateResult gate = judge(with_track(track, 0.7 * std::abs(track)), kFirm);
    EXPECT_EQ(gate.verdict, Verdict::refused);
    ASSERT_EQ(gate.reasons.size(), 1U) << "neither swapped wheels nor wrong units";
    EXPECT_NE(gate.reasons[0].find("is determined to 70 % only"), std::string::npos) << gate.reasons[0];
  }
}

// Whatever the values are: without a test nobody has seen them predict anything.
TEST(Gate, warns_of_a_drive_of_which_nothing_was_tested) {
  Calibration calibration = sound();
  calibration.residual.held_out = false;
  const GateResult gate = judge(calibration, kFirm);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("takes more than one block of 20 s"), std::string::npos) << gate.reasons[0];
  EXPECT_EQ(gate.next_step, "drive longer, a minute or more, and solve again");
  VerdictEvidence of_few_pairs = kFirm;
  of_few_pairs.drive_errors = {
      {"full_turn_heading", "rad", 3, Bounded{0.3, 0.2, 0.4}, std::nullopt, Bounded{0.01, 0.0, 0.02}, 0.01}};
  EXPECT_EQ(judge(calibration, of_few_pairs).verdict, Verdict::accepted);
  calibration.residual.held_out = true;
  EXPECT_EQ(judge(calibration, kFirm).verdict, Verdict::accepted);
}

TEST(Gate, accepts_what_only_a_law_of_unknown_shape_makes_uncertain_and_says_so) {
  Calibration uncertain = with_track(0.4, 0.0121);
  uncertain.effects.resize(1);
  VerdictEvidence evidence = kFirm;
  evidence.measured = {{"track_width", {0.4, 1e-4, "m"}}};
  const GateResult gate = judge(uncertain, evidence);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons.front().find("track_width without what was found"), std::string::npos)
      << gate.reasons.front();
  evidence.measured.front().second.std = 0.0121;
  EXPECT_EQ(judge(uncertain, evidence).verdict, Verdict::refused);
}

TEST(Gate, does_not_speak_of_what_was_found_where_nothing_was) {
  VerdictEvidence evidence = kFirm;
  evidence.measured = {{"track_width", {0.4, 1e-4, "m"}}};
  const GateResult gate = judge(with_track(0.4, 0.0121), evidence);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_EQ(gate.reasons.front().find("track_width is known to 3.0"), 0U) << gate.reasons.front();
  EXPECT_EQ(gate.next_step, "record longer, and solve again");
}

TEST(Gate, warns_of_a_way_that_adds_up_to_more_than_noise) {
  VerdictEvidence evidence = kFirm;
  const auto drifting = [&](double value, double low) {
    evidence.drive_errors = {
        {"open_loop_10s_position", "m", 20, {}, {}, Bounded{value, low, 2.0 * value}, 0.004}};
    return judge(sound(), evidence);
  };
  EXPECT_EQ(drifting(0.0079, 0.006).verdict, Verdict::accepted);
  EXPECT_EQ(drifting(0.0096, 0.0039).verdict, Verdict::accepted) << "a few stretches may have made that";
  const GateResult gate = drifting(0.0096, 0.0041);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons.front().find("2.4 times the noise floor"), std::string::npos)
      << gate.reasons.front();
}

DriveError figure(const char* name, double before, double after) {
  return {name, "m", 20, Bounded{before, 0.001, 0.2}, {}, Bounded{after, 0.001, 0.2}, 0.030};
}

GateResult driven(std::vector<DriveError> errors) {
  VerdictEvidence evidence = kFirm;
  evidence.drive_errors = std::move(errors);
  return judge(with_track(0.4, 0.0021), evidence);
}

TEST(Gate, refuses_where_nothing_that_was_off_is_better) {
  const GateResult gate = driven({figure("straight_metre_length", 0.0468, 0.0472)});
  EXPECT_EQ(gate.verdict, Verdict::refused);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons.front().find("straight metre is no better than before"), std::string::npos)
      << gate.reasons.front();
  EXPECT_EQ(gate.next_step, "keep the old values");
  EXPECT_EQ(driven({figure("straight_metre_length", 0.0468, 0.0460)}).reasons.size(), 1U) << "better";
  EXPECT_EQ(driven({figure("straight_metre_length", 0.0310, 0.0320)}).reasons.size(), 1U)
      << "there was nothing to gain";
}

TEST(Gate, refuses_poses_that_are_computed_of_the_counts) {
  Calibration robot = with_track(0.4, 0.0021);
  robot.robot.ticks_per_rev = 4096.0;
  const auto seen = [&](double after, MotionSource motion, bool of_poses) {
    VerdictEvidence evidence = kFirm;
    evidence.drive_errors = {figure("open_loop_10s_position", 0.05, after)};
    evidence.motion = motion;
    evidence.of_poses = of_poses;
    return judge(robot, evidence);
  };
  const GateResult gate = seen(3e-6, MotionSource::ticks, true);
  EXPECT_EQ(gate.verdict, Verdict::refused);
  EXPECT_THAT(gate.reasons.front(), HasSubstr("to 0.003 mm over ten seconds"));
  EXPECT_THAT(gate.next_step, HasSubstr("poses that something else measures"));
  const double step = math::kPi * robot.robot.left_wheel_diameter / robot.robot.ticks_per_rev;
  EXPECT_EQ(seen(0.19 * step, MotionSource::ticks, true).verdict, Verdict::refused);
  EXPECT_NE(seen(0.21 * step, MotionSource::ticks, true).verdict, Verdict::refused);
  EXPECT_NE(seen(3e-6, MotionSource::ticks, false).verdict, Verdict::refused) << "scans";
  EXPECT_THAT(seen(3e-6, MotionSource::wheels, true).reasons, Contains(HasSubstr("computed of the wheels")));
  EXPECT_NE(seen(3e-6, MotionSource::wheels, true).verdict, Verdict::refused) << "an exact simulation";
  EXPECT_THAT(seen(2e-5, MotionSource::wheels, true).reasons,
              Not(Contains(HasSubstr("computed of the wheels"))));
}

TEST(Gate, warns_of_one_figure_that_is_no_better_where_another_is) {
  const GateResult gate = driven(
      {figure("straight_metre_length", 0.0468, 0.0472), figure("open_loop_10s_position", 0.0900, 0.0400)});
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 2U);
  EXPECT_EQ(gate.reasons.front().find("keep the old values"), std::string::npos) << gate.reasons.front();
}

TEST(Gate, says_of_a_recording_that_determines_nothing_that_it_is_too_short) {
  Calibration nothing = sound();
  for (auto& [name, quantity] : nothing.parameters)
    if (!name.starts_with("lidar_")) quantity.std = 0.2 * quantity.value;
  VerdictEvidence evidence = kFirm;
  evidence.pairs = 19;
  const GateResult gate = judge(nothing, evidence);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_EQ(gate.reasons.front().find("too short: 19 measured motions"), 0U) << gate.reasons.front();
  evidence.pairs = 20;
  EXPECT_EQ(judge(nothing, evidence).reasons.size(), 3U) << "long enough to say of each what is missing";
}

/// The next step follows from the weightiest reason, never from all of them.
TEST(Gate, says_what_to_do_next_by_the_weightiest_reason) {
  EXPECT_EQ(judge(sound(), kFirm).next_step, "");
  Calibration half = with_track(0.81, 1e-4);  // which is measured from the middle
  EXPECT_EQ(judge(half, kFirm).next_step,
            "correct robot.toml, or the recording, as the first reason says, and solve again");
  VerdictEvidence evidence = kFirm;
  evidence.remarks = {"stamps jitter"};
  EXPECT_EQ(judge(sound(), evidence).next_step, "read what the reasons say of the recording");
  EXPECT_NE(judge(with_track(0.45, 1e-4), evidence).next_step.find("measure it with a tape"),
            std::string::npos)
      << "lengths weigh more than remarks";
  Calibration open = with_track(0.4, 0.1);
  evidence.missing_motion = "turns on the spot, both ways";
  EXPECT_EQ(judge(open, evidence).next_step, "record turns on the spot, both ways, and solve again");
  EXPECT_EQ(next_after({ErrorCode::format, "yaw looks like degrees", "a.jsonl", "multiply yaw by pi / 180"}),
            "multiply yaw by pi / 180; then solve again");
}

TEST(Gate, says_that_something_has_no_name) {
  Calibration calibration = sound();
  calibration.unexplained = Unexplained{};
  calibration.unexplained->depends_on = {"incidence", "range"};
  const GateResult gate = judge(calibration, kFirm);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons.front().find("depends on incidence, range and has no name"), std::string::npos)
      << gate.reasons.front();
}

TEST(Gate, refuses_what_cannot_be_the_robot) {
  EXPECT_EQ(judge(with_track(0.43, 1e-4), kFirm).verdict, Verdict::accepted);
  EXPECT_EQ(judge(with_track(0.45, 1e-4), kFirm).verdict, Verdict::accepted_with_warnings);
  EXPECT_EQ(judge(with_track(0.81, 1e-4), kFirm).verdict, Verdict::refused);
  EXPECT_EQ(judge(with_track(0.19, 1e-4), kFirm).verdict, Verdict::refused);
  EXPECT_EQ(judge(with_track(-0.4, 1e-4), kFirm).verdict, Verdict::refused);
}

TEST(Gate, warns_of_a_lidar_that_looks_elsewhere_than_its_description_says) {
  const auto with_yaw = [](double yaw) {
    Calibration calibration = sound();
    calibration.robot.lidar_pose = {0.1, 0.0, 3.1};
    calibration.parameters.push_back({"lidar_yaw", {yaw, 1e-3, "rad"}});
    return judge(calibration, kFirm);
  };
  EXPECT_EQ(with_yaw(-3.0).verdict, Verdict::accepted);
  const GateResult gate = with_yaw(0.0);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("-178 degrees"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, warns_of_odometry_whose_heading_is_not_that_of_the_wheels) {
  const auto with = [](double left, double right, double track, MotionSource motion) {
    Calibration calibration = sound();
    const std::array changes = {left, right, track};
    for (std::size_t k = 0; k < changes.size(); ++k) {
      auto& [name, quantity] = calibration.parameters[k];
      quantity = {(name == "track_width" ? 0.4 : 0.15) * (1.0 + changes[k]), 1e-5, "m"};
    }
    VerdictEvidence evidence = kFirm;
    evidence.motion = motion;
    return judge(calibration, evidence);
  };
  const GateResult gate = with(-0.02199, -0.02198, -0.02197, MotionSource::odometry);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("one factor, -2.20 %"), std::string::npos) << gate.reasons[0];
  EXPECT_EQ(with(-0.02199, -0.02198, -0.02197, MotionSource::ticks).verdict, Verdict::accepted);
  EXPECT_EQ(with(-0.02199, -0.02140, -0.02197, MotionSource::odometry).verdict, Verdict::accepted);
  EXPECT_EQ(with(1e-5, 1e-5, 1e-5, MotionSource::odometry).verdict, Verdict::accepted) << "nothing changed";
}

TEST(Gate, refuses_values_of_the_few_scans_that_happened_to_match) {
  EXPECT_EQ(judge(sound(), {true, 50, 50, {}}).verdict, Verdict::accepted);
  EXPECT_EQ(judge(sound(), {true, 49, 51, {}}).verdict, Verdict::accepted_with_warnings);
  EXPECT_EQ(judge(sound(), {true, 10, 90, {}}).verdict, Verdict::accepted_with_warnings);
  const GateResult gate = judge(sound(), {true, 9, 91, {}});
  EXPECT_EQ(gate.verdict, Verdict::refused);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("9 of 100"), std::string::npos) << gate.reasons[0];
  EXPECT_EQ(judge(sound(), VerdictEvidence{}).verdict, Verdict::accepted)
      << "places in a map, poses or tuples";
}

TEST(Gate, asks_for_more_matches_where_most_leave_a_direction_open) {
  VerdictEvidence evidence{true, 45, 55, {}};
  EXPECT_EQ(judge(sound(), evidence).verdict, Verdict::accepted_with_warnings);
  evidence.partial = 30;
  EXPECT_EQ(judge(sound(), evidence).verdict, Verdict::refused);
  evidence = {true, 55, 45, {}};
  evidence.partial = 40;
  EXPECT_EQ(judge(sound(), evidence).verdict, Verdict::accepted);
}

TEST(Gate, asks_for_walls_where_lengths_are_open_because_matches_are) {
  VerdictEvidence evidence{true, 60, 10, {}};
  evidence.partial = 58;
  evidence.missing_motion = "turns on the spot, both ways";
  const GateResult gate = judge(with_track(0.4, 0.0121), evidence);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("58 of 60 pairs of scans leave one direction open"), std::string::npos);
  EXPECT_EQ(gate.reasons[0].find("turns on the spot"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, names_no_cause_by_few_motions_and_says_how_few_readings_there_were) {
  for (const double track : {1.6, -0.4}) {
    VerdictEvidence evidence{true, 19, 0, {}};
    evidence.pairs = 19;
    evidence.readings = 17;
    evidence.beams = 361;
    const GateResult few = judge(with_track(track, 1e-4), evidence);
    EXPECT_EQ(few.verdict, Verdict::refused);
    ASSERT_EQ(few.reasons.size(), 1U);
    EXPECT_NE(few.reasons[0].find("by 19 measured motions only"), std::string::npos) << few.reasons[0];
    EXPECT_NE(few.reasons[0].find("17 of 361 readings"), std::string::npos) << few.reasons[0];
    for (const char* accusation : {"ticks per revolution", "swapped", "direction of rotation"})
      EXPECT_EQ(few.reasons[0].find(accusation), std::string::npos) << few.reasons[0];
    evidence.pairs = 20;
    EXPECT_EQ(judge(with_track(track, 1e-4), evidence).reasons[0].find("measured motions only"),
              std::string::npos);
  }
}

TEST(Gate, says_of_lengths_by_hardly_any_match_only_that) {
  VerdictEvidence evidence{true, 5, 117, {}};
  evidence.pairs = 5;
  evidence.readings = 24;
  evidence.beams = 361;
  evidence.stood = 3;
  const GateResult gate = judge(with_track(1.6, 1e-4), evidence);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("only 5 of 125 pairs"), std::string::npos) << gate.reasons[0];
  EXPECT_NE(gate.reasons[0].find("in 3 the wheels turned"), std::string::npos) << gate.reasons[0];
  EXPECT_NE(gate.reasons[0].find(", with 24 of 361 readings a scan"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, says_of_scans_with_too_few_readings_beside_each_other_what_to_look_at) {
  VerdictEvidence evidence{true, 5, 120, {}};
  evidence.readings = 90;
  evidence.beams = 180;
  evidence.too_thin = 60;
  EXPECT_EQ(judge(sound(), evidence).reasons.at(0).find("90 of 180"), std::string::npos) << "of other causes";
  evidence.too_thin = 61;
  const GateResult gate = judge(sound(), evidence);
  EXPECT_NE(gate.reasons.at(0).find("with 90 of 180 readings a scan: too few beside each other"),
            std::string::npos)
      << gate.reasons[0];
  EXPECT_NE(gate.next_step.find("leaves readings out"), std::string::npos) << gate.next_step;
}

// Longer lines do not help where the scans are not what was seen.
TEST(Gate, says_of_lengths_that_few_matches_leave_open_that_the_scans_do_not_match) {
  Calibration calibration = sound();
  calibration.parameters[0].second.std = 0.15 * calibration.parameters[0].second.value;
  VerdictEvidence evidence{true, 49, 51, {}};
  evidence.pairs = 49;
  const GateResult gate = judge(calibration, evidence);
  EXPECT_NE(gate.reasons.at(0).find("only 49 of 100 pairs"), std::string::npos) << gate.reasons[0];
  EXPECT_NE(gate.reasons[0].find("angle_increment"), std::string::npos) << gate.reasons[0];
  EXPECT_EQ(gate.reasons[0].find("straight lines"), std::string::npos) << gate.reasons[0];
  evidence.matched = 50, evidence.unmatched = 50;
  EXPECT_NE(judge(calibration, evidence).reasons.at(0).find("straight lines"), std::string::npos);
}

TEST(Gate, holds_each_length_to_its_own_nominal_value_where_there_is_one) {
  Calibration calibration = sound();
  calibration.robot.left_wheel_diameter = calibration.parameters[0].second.value = 0.12;
  EXPECT_EQ(judge(calibration, kFirm).verdict, Verdict::accepted);
  calibration.robot.track_width = 0.0;
  EXPECT_EQ(judge(calibration, kFirm).verdict, Verdict::accepted) << "not known";
}

TEST(Gate, names_a_common_factor_once_and_by_enough_motions_only) {
  Calibration calibration = sound();
  for (auto& [name, quantity] : calibration.parameters)
    if (!name.starts_with("lidar_")) quantity.value *= 0.5;
  constexpr const char* kAll = "both wheel diameters and the track width come out";
  VerdictEvidence evidence{true, 20, 0, {}};
  evidence.pairs = 20;
  const GateResult enough = judge(calibration, evidence);
  ASSERT_EQ(enough.reasons.size(), 1U) << enough.reasons[1];
  EXPECT_NE(enough.reasons[0].find(kAll), std::string::npos) << enough.reasons[0];
  evidence.pairs = 19;
  for (const std::string& reason : judge(calibration, evidence).reasons)
    EXPECT_EQ(reason.find(kAll), std::string::npos) << reason;
  EXPECT_NE(judge(calibration, kFirm).reasons[0].find(kAll), std::string::npos);
}

TEST(PoorMatches, are_told_where_few_of_those_tried_are_left) {
  EXPECT_FALSE(poor_matches({true, 399, 1, {}}));
  EXPECT_FALSE(poor_matches({true, 400, 0, {}}));
  EXPECT_FALSE(poor_matches({true, 0, 0, {}})) << "nothing was tried";
  EXPECT_TRUE(poor_matches({true, 9, 91, {}}));
}

TEST(Gate, warns_of_a_residual_that_noise_does_not_explain) {
  Calibration calibration = sound();
  calibration.residual.noise_floor = {{1e-3, 1e-3, 5e-4}};
  calibration.residual.after = {{1.9e-3, 1e-3, 9e-4}};
  EXPECT_EQ(judge(calibration, kFirm).verdict, Verdict::accepted);
  calibration.residual.after = {{1.9e-3, 1e-3, 1.8e-3}};
  const GateResult gate = judge(calibration, kFirm);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("in yaw is 3.6 times"), std::string::npos) << gate.reasons[0];
}

TEST(Gate, passes_remarks_on) {
  const GateResult gate = judge(sound(), {true, 400, 20, {"24 of 546 pairs contradict all others"}});
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_NE(gate.reasons[0].find("24 of 546"), std::string::npos);
}

VerdictEvidence with_loss(double share, bool of_wheels = true) {
  VerdictEvidence evidence = kFirm;
  evidence.losses = {{share, "363 of 1916 intervals between counts", of_wheels}};
  return evidence;
}

TEST(Gate, warns_of_a_share_that_was_left_out_and_refuses_where_little_is_left) {
  const double warned = settings::kWarnLeftOut, refused = settings::kMostLeftOut;
  EXPECT_EQ(judge(sound(), with_loss(0.9 * warned)).verdict, Verdict::accepted);
  const GateResult gate = judge(sound(), with_loss(1.1 * warned));
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(gate.reasons.size(), 1U);
  EXPECT_EQ(gate.reasons[0].find("363 of 1916 intervals between counts"), 0U) << gate.reasons[0];
  EXPECT_EQ(judge(sound(), with_loss(0.99 * refused)).verdict, Verdict::accepted_with_warnings);
  EXPECT_EQ(judge(sound(), with_loss(1.01 * refused)).verdict, Verdict::refused);
  EXPECT_EQ(judge(sound(), with_loss(1.01 * refused, false)).verdict, Verdict::accepted_with_warnings)
      << "fewer scans are still scans";
}

/// Figures at so many times the limits of as many rules: residual, odometry over ten seconds; and a length
/// that is far from nominal, which weighs once.
GateResult judged(double residual, double odometry, double track = 0.5, std::size_t outliers = 0) {
  Calibration calibration = with_track(track, 1e-4);
  calibration.residual.noise_floor = {{1e-3, 1e-3, 5e-4}};
  calibration.residual.after = {{settings::kWarnResidual * residual * 1e-3, 1e-3, 5e-4}};
  VerdictEvidence evidence = kFirm;
  evidence.pairs = 100;
  evidence.outliers = outliers;
  const double error = settings::kWarnResidual * odometry * 0.004;
  evidence.drive_errors = {
      {"open_loop_10s_position", "m", 20, {}, {}, Bounded{error, 0.9 * error, 1.1 * error}, 0.004}};
  return judge(calibration, evidence);
}

TEST(Gate, refuses_when_signs_of_different_rules_add_up_and_names_the_weightiest) {
  constexpr double kOdometry = 1.5, kRest = settings::kMostSigns - kOdometry - 1.0;
  static_assert(kRest > kOdometry && kRest < settings::kHeaviestSign);
  EXPECT_EQ(judged(kRest - 0.1, kOdometry).verdict, Verdict::accepted_with_warnings);
  EXPECT_EQ(judged(kRest + 0.1, kOdometry, 0.41).verdict, Verdict::accepted_with_warnings);
  const GateResult gate = judged(kRest + 0.1, kOdometry);
  EXPECT_EQ(gate.verdict, Verdict::refused);
  ASSERT_EQ(gate.reasons.size(), 1U);
  for (const char* said :
       {": the residual in x of the sensor is 6.8 times the noise floor; odometry over ten seconds is off by",
        "; track_width differs"})
    EXPECT_NE(gate.reasons[0].find(said), std::string::npos) << gate.reasons[0];
}

TEST(Gate, one_sign_alone_never_refuses_however_heavy) {
  const GateResult gate = judged(1000.0, 0.5, 0.41);
  EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
  EXPECT_EQ(gate.reasons.size(), 1U);
}

TEST(Gate, what_a_remark_says_of_outliers_weighs_and_is_said_once) {
  VerdictEvidence evidence = kFirm;
  evidence.pairs = 100;
  evidence.outliers = 20;
  evidence.remarks = {"20 of 100 pairs contradict all others"};
  EXPECT_EQ(judge(sound(), evidence).reasons.size(), 1U);
  evidence.outliers = 26;
  EXPECT_EQ(judge(sound(), evidence).verdict, Verdict::refused);
}

// The warning names the component, of three; twice the noise floor is tried on both sides.
TEST(Gate, warns_of_each_component_of_the_residual_beyond_twice_the_noise) {
  const char* const kNames[] = {"in x of the sensor", "in y of the sensor", "in yaw"};
  for (std::size_t i = 0; i < 3; ++i) {
    Calibration calibration = sound();
    calibration.residual.noise_floor = {{1e-3, 2e-3, 5e-4}};
    calibration.residual.after = calibration.residual.noise_floor;
    (*calibration.residual.after)[i] *= 1.99;
    EXPECT_EQ(judge(calibration, kFirm).verdict, Verdict::accepted) << kNames[i];
    (*calibration.residual.after)[i] *= 2.01 / 1.99;
    const GateResult gate = judge(calibration, kFirm);
    EXPECT_EQ(gate.verdict, Verdict::accepted_with_warnings);
    ASSERT_EQ(gate.reasons.size(), 1U) << kNames[i];
    EXPECT_NE(gate.reasons[0].find(std::string("the residual ") + kNames[i] + " is "), std::string::npos)
        << gate.reasons[0];
  }
}

/// The joint fit and the closed form, so far apart.
GateResult apart(double metres, double deviation_ours, double deviation_theirs, bool effects = false) {
  Calibration calibration = sound();
  MethodResult joint, closed;
  joint.name = "joint";
  joint.parameters = {{"track_width", {0.41, deviation_ours, "m"}}, {"lidar_x", {0.1, 1e-6, "m"}}};
  closed.name = "joint_closed_form";
  closed.parameters = {{"track_width", {0.41 + metres, deviation_theirs, "m"}},
                       {"lidar_x", {0.2, 1e-6, "m"}}};
  calibration.methods = {closed, joint};
  if (effects) calibration.effects.push_back({"backlash", {}, {}, {}, "host"});
  return judge(calibration, kFirm);
}

// Six common deviations, and half a per cent of the length: both, and in both directions.
TEST(Gate, warns_of_two_estimators_that_are_apart) {
  for (const double way : {1.0, -1.0}) {
    EXPECT_EQ(apart(way * 0.00203, 1e-5, 1e-5).verdict, Verdict::accepted) << "0.495 %";
    EXPECT_EQ(apart(way * 0.00207, 1e-5, 1e-5).verdict, Verdict::accepted_with_warnings) << "0.505 %";
    EXPECT_EQ(apart(way * 0.00590, 1e-3, 0.0).verdict, Verdict::accepted) << "5.9 of ours";
    EXPECT_EQ(apart(way * 0.00610, 1e-3, 0.0).verdict, Verdict::accepted_with_warnings);
    EXPECT_EQ(apart(way * 0.00590, 0.0, 1e-3).verdict, Verdict::accepted) << "5.9 of theirs";
    EXPECT_EQ(apart(way * 0.00610, 0.0, 1e-3).verdict, Verdict::accepted_with_warnings);
    EXPECT_EQ(apart(way * 0.00838, 1e-3, 1e-3).verdict, Verdict::accepted) << "5.93 of both";
    EXPECT_EQ(apart(way * 0.00860, 1e-3, 1e-3).verdict, Verdict::accepted_with_warnings) << "6.08 of both";
  }
  EXPECT_EQ(apart(0.02, 1e-5, 1e-5, true).verdict, Verdict::accepted) << "the closed form knows no effects";
  const GateResult gate = apart(0.0082, 1e-3, 0.0);
  ASSERT_EQ(gate.reasons.size(), 1U) << "not of the lidar's place";
  for (const char* said : {"disagree on track_width", "closed form is 2", "8.2 of their common deviations"})
    EXPECT_NE(gate.reasons[0].find(said), std::string::npos) << gate.reasons[0];
}

// A tenth of the motions adds to other signs, and a quarter refuses.
TEST(Gate, of_motions_that_contradict_the_others_a_tenth_is_a_sign_and_a_quarter_refuses) {
  constexpr double kOdometry = 1.5, kRest = settings::kMostSigns - kOdometry - 0.95;
  const auto with_other_signs = [](std::size_t outliers) {
    return judged(kRest, kOdometry, 0.41, outliers).verdict;
  };
  EXPECT_EQ(with_other_signs(10), Verdict::accepted_with_warnings);
  EXPECT_EQ(with_other_signs(11), Verdict::refused);
  const auto alone = [](std::size_t outliers, std::size_t pairs) {
    VerdictEvidence evidence = kFirm;
    evidence.pairs = pairs;
    evidence.outliers = outliers;
    return judge(sound(), evidence);
  };
  EXPECT_EQ(alone(25, 100).verdict, Verdict::accepted);
  ASSERT_EQ(alone(26, 100).verdict, Verdict::refused);
  EXPECT_NE(alone(26, 100).reasons[0].find("one set of lengths does not describe this robot"),
            std::string::npos);
  ASSERT_EQ(alone(5, 19).verdict, Verdict::refused);
  EXPECT_NE(alone(5, 19).reasons[0].find("19 measured motions only"), std::string::npos);
}

// One, two or all three, and none at all is no length either.
TEST(Gate, refuses_lengths_that_are_not_positive_and_says_what_that_is_a_sign_of) {
  const auto with = [](double left, double right, double track) {
    Calibration calibration = sound();
    calibration.parameters[0].second = {left, 1e-9, "m"};
    calibration.parameters[1].second = {right, 1e-9, "m"};
    calibration.parameters[2].second = {track, 1e-9, "m"};
    return judge(calibration, kFirm);
  };
  EXPECT_EQ(with(0.15, 0.15, 0.4).verdict, Verdict::accepted);
  const GateResult one = with(0.15, -0.15, 0.4);
  EXPECT_EQ(one.verdict, Verdict::refused);
  ASSERT_EQ(one.reasons.size(), 1U);
  EXPECT_NE(one.reasons[0].find("right_wheel_diameter came out as a non-positive length"), std::string::npos);
  EXPECT_EQ(with(-0.15, -0.15, 0.4).reasons.size(), 2U);
  const GateResult all = with(-0.15, -0.15, -0.4);
  EXPECT_EQ(all.verdict, Verdict::refused);
  ASSERT_EQ(all.reasons.size(), 1U);
  EXPECT_NE(all.reasons[0].find("looks backwards"), std::string::npos);
  const GateResult endless = with(0.15, 0.15, std::numeric_limits<double>::infinity());
  ASSERT_EQ(endless.reasons.size(), 1U);
  EXPECT_NE(endless.reasons[0].find("track_width came out as a non-positive length"), std::string::npos)
      << endless.reasons[0];
}

TEST(Gate, warns_of_a_fit_that_has_not_settled) {
  EXPECT_EQ(judge(sound(), {false, 400, 20, {}}).verdict, Verdict::accepted_with_warnings);
}

}  // namespace
}  // namespace odomcalib::calib::report::gate_test
