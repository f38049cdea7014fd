// Recordings as strangers made them, each with what it should come to: right lengths, or its true fault by
// name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>

#include "calib/solve.hpp"
#include "daemon/config/robot_file.hpp"
#include "proto/recording/recording.hpp"
#include "tests/shared_folder.hpp"

namespace odomcalib::stranger_cases_test {
namespace {

using ::testing::ContainsRegex;

std::filesystem::path cases() { return shared_folder("cases"); }

struct Stranger {
  std::string name;
  std::string file;
  std::string
      says;  ///< regular expression, of the refusal or of what was put right; empty: nothing need be said
  bool is_refused = false;  ///< otherwise lengths are right
  std::vector<std::string> topics = {};
};

std::ostream& operator<<(std::ostream& out, const Stranger& one) { return out << one.name; }

constexpr const char* kFrontOfCar = "wheels=/joint_states:front_left_wheel_joint,front_right_wheel_joint";
constexpr const char* kRearOfCar = "wheels=/joint_states:rear_left_wheel_joint,rear_right_wheel_joint";

const std::vector<Stranger>& strangers() {
  static const std::vector<Stranger> all = {
      {"boot_then_epoch", "boot-then-epoch/boot_then_epoch.mcap.gz", "times of reception"},
      {"clock_step_0_1", "clock-step-of-one-device/scans_0.1.jsonl.gz", "step by -?0\\.[01][0-9] s"},
      {"clock_step_0_5", "clock-step-of-one-device/scans_0.5.jsonl.gz", "step by 0\\.(4[89]|5[0-2]) s"},
      {"no_clock_step", "clock-step-of-one-device/no_step.jsonl.gz", ""},
      {"degrees", "joint-units/angles_in_degrees.mcap.gz", "look like degrees", true},
      {"millimetres", "joint-units/angles_in_mm.mcap.gz", "look like millimetres", true},
      {"turns", "joint-units/angles_in_turns.mcap.gz", "look like turns", true},
      {"rpm", "joint-units/speeds_in_rpm.mcap.gz", "look like rpm:", true},
      {"rpm_times_10", "joint-units/speeds_in_rpm_times_10.mcap.gz", "look like rpm times 10", true},
      {"no_schema", "mcap-without-schemas/no_schema.mcap.gz", "no schema.*--topic", true},
      {"odometry_base", "odometry-of-another-frame/base.mcap.gz", ""},
      {"odometry_turned", "odometry-of-another-frame/child_turned_5_degrees.mcap.gz",
       "goes sideways over 8\\.7 % of its way.*turned 5\\.0 degrees", true},
      {"odometry_of_a_filter", "odometry-of-another-frame/yaw_of_a_filter_place_of_the_wheels.mcap.gz",
       "goes sideways over .* do not belong together", true},
      {"one_wheel_a_message", "one-wheel-a-message/one_topic.mcap.gz", "one wheel only"},
      {"one_wheel_a_topic", "one-wheel-a-message/two_topics.mcap.gz", "one wheel only"},
      {"whole_turns", "partial-turns/whole.jsonl.gz", ""},
      {"turns_in_4_parts", "partial-turns/parts_4.jsonl.gz", "a turn comes in 4 messages"},
      {"turns_in_10_parts", "partial-turns/parts_10.jsonl.gz", "a turn comes in 10 messages"},
      {"each_scan_twice", "repeated-scans/each_twice.jsonl.gz", "same values as the one before"},
      {"one_scan_in_ten_again", "repeated-scans/one_in_ten.jsonl.gz", "same values as the one before"},
      {"four_scans_in_ten_again", "repeated-scans/four_in_ten.jsonl.gz", "same values as the one before"},
      {"front_wheels_of_a_car", "steered-wheels/car.mcap.gz", "several signs", true, {kFrontOfCar}},
      {"rear_wheels_of_a_car", "steered-wheels/car.mcap.gz", "", false, {kRearOfCar}},
      {"one_publisher", "two-joint-state-publishers/one.mcap.gz", ""},
      {"zeros_at_5_hz", "two-joint-state-publishers/zeros_at_5_hz.mcap.gz", "never change"},
      {"zeros_at_25_hz", "two-joint-state-publishers/zeros_at_25_hz.mcap.gz", "never change"},
      {"two_lidars_of_half_turns", "two-lidars-one-topic/half_turns.mcap.gz", "front_laser.*rear_laser"},
      {"two_lidars_of_three_quarters", "two-lidars-one-topic/three_quarters.mcap.gz",
       "front_laser.*rear_laser"},
      {"two_lidars_of_whole_turns", "two-lidars-one-topic/whole_turns.mcap.gz", "front_laser.*rear_laser"},
      {"head_that_wanders", "varying-beam-count/fixed_increment.jsonl.gz", "the speed of the head wanders"},
      {"head_that_wanders_told", "varying-beam-count/true_increment.jsonl.gz", ""},
      {"joints_in_whole_seconds", "wheel-stamps-whole-seconds/joint_states.mcap.gz", "times of reception"},
      {"odometry_in_whole_seconds", "wheel-stamps-whole-seconds/odometry.mcap.gz", "times of reception"},
      {"wheels_in_whole_seconds", "wheel-stamps-whole-seconds/wheels.jsonl.gz", "carry the same time stamp",
       true},
      {"ticks_in_whole_seconds", "wheel-stamps-whole-seconds/ticks.jsonl.gz", "carry the same time stamp",
       true},
      {"wheels_that_roll_sideways", "four-wheels-and-mecanum/strafing.mcap.gz", "sees the robot go sideways",
       true},
      {"four_wheels", "four-wheels-and-mecanum/no_strafing.mcap.gz",
       "the rear pair is taken; the front pair: --topic wheels=/joint_states:front_left_wheel_joint"}};
  return all;
}

struct Outcome {
  Calibration calibration;
  std::string text;  ///< whatever is told
};

Outcome solved(const Stranger& stranger) {
  Outcome outcome;
  const std::filesystem::path file = cases() / stranger.file, robot_file = file.parent_path() / "robot.toml";
  RobotDescription robot;
  const bool has_robot = std::filesystem::exists(robot_file);
  if (has_robot) robot = read_robot_file(robot_file).value();
  TopicChoices topics;
  for (const std::string& topic : stranger.topics) topics.push_back(parse_topic_choice(topic).value());
  const auto read = read_recording(file, has_robot ? &robot : nullptr, topics);
  if (!read) {
    for (const std::string& remark : read.error().remarks) outcome.text += remark + " ";
    outcome.text += read.error().text();
    return outcome;
  }
  for (const std::string& choice : read.value().choices) outcome.text += choice + " ";
  outcome.calibration = calib::solve({&read.value(), 1}, {});
  for (const std::string& reason : outcome.calibration.reasons) outcome.text += reason + " ";
  for (const Repair& one : outcome.calibration.repairs)
    outcome.text += one.what + ": " + one.chosen + ", " + one.reason + " ";
  for (const Discarded& one : outcome.calibration.discarded)
    outcome.text += one.what + ": " + one.reason + " ";
  return outcome;
}

nlohmann::json truth_of(const std::filesystem::path& file) {
  for (const std::filesystem::path& path :
       {file.parent_path() /
            (file.filename().string().substr(0, file.filename().string().find('.')) + ".truth.json"),
        file.parent_path() / "truth.json"})
    if (std::filesystem::exists(path)) {
      const auto json = nlohmann::json::parse(std::ifstream(path));
      return json.contains("true") ? json["true"] : json;
    }
  return {};
}

class Strangers : public ::testing::TestWithParam<Stranger> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(cases() / GetParam().file))
      GTEST_SKIP() << "no cases: set ODOMCALIB_SHARED to the folder that holds cases/";
  }
};

TEST_P(Strangers, are_calibrated_rightly_or_told_what_is_wrong) {
  const Stranger& stranger = GetParam();
  const Outcome outcome = solved(stranger);
  EXPECT_THAT(outcome.text, ContainsRegex(stranger.says));
  EXPECT_EQ(outcome.calibration.verdict == Verdict::refused, stranger.is_refused) << outcome.text;
  if (stranger.is_refused) {
    EXPECT_THAT(outcome.text, ::testing::Not(ContainsRegex("ticks_per_rev")));
    return;
  }
  const auto truth = truth_of(cases() / stranger.file);
  for (const auto& [name, key] : {std::pair("left_wheel_diameter", "left_diameter"),
                                  {"right_wheel_diameter", "right_diameter"},
                                  {"track_width", "track_width"}}) {
    if (!truth.contains(key)) continue;
    for (const auto& [own, quantity] : outcome.calibration.parameters)
      if (own == name) {
        EXPECT_LT(std::abs(quantity.value - truth[key].get<double>()), 3.0 * quantity.std) << name;
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Strangers, ::testing::ValuesIn(strangers()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace odomcalib::stranger_cases_test
