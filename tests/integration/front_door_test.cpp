// Every cell of the table of faults: a drive told in each form, with each fault and without. With the fault
// it is told, put right or listed as the table says; without, nothing is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "calib/ingest/checks.hpp"
#include "calib/solve.hpp"
#include "proto/recording/recording.hpp"
#include "tests/integration/recording_faults.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::front_door_test {
namespace {

using calib::ingest::Answer;
using recording_faults::Form;
using recording_faults::makers;
using recording_faults::told_as;
using ::testing::ContainsRegex;

// Relative error of a length of a recording that was put right; the drive determines them to 0.0005.
constexpr double kRight = 0.004;

const sim::SimulatedRun& drive() {
  static const sim::SimulatedRun run = [] {
    sim::SimulationConfig config = sim::standard_config(11);
    config.duration = 110.0;
    return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
  }();
  return run;
}

/// Words of the answer, a regular expression. Empty where putting the fault right is all.
struct Words {
  std::string of_all;
  std::map<Form, std::string> of_form = {};
  [[nodiscard]] const std::string& of(Form form) const {
    const auto own = of_form.find(form);
    return own == of_form.end() ? of_all : own->second;
  }
};

const std::map<std::string, Words>& words() {
  static const std::map<std::string, Words> all = {
      {"lost_digits", {"carry the same time stamp"}},
      {"clock_was_set", {"counted since it was switched on"}},
      {"time_unit", {"look like milliseconds"}},
      {"clock_step", {"step by -?0\\.[34][0-9] s"}},
      {"clock_rate", {"clock of the|stamps of the scans run too slowly"}},
      {"order", {"out of order by more than 1 s"}},
      {"second_writer", {"of a second program"}},
      {"repeated", {"same values as the one before"}},
      {"several_sources", {"front \\([0-9]+\\), rear"}},
      {"value_unit",
       {"",
        {{Form::ticks, "one edge of a period, the recorded counts all four"},
         {Form::wheels, "look like degrees"},
         {Form::wheel_speeds, "look like rpm"},
         {Form::odometry, "look like centimetres"},
         {Form::pose, "in millimetres"},
         {Form::scan, "look like millimetres"}}}},
      {"heading_unit", {"yaw looks like degrees"}},
      {"not_of_two_wheels",
       {"goes sideways over 8\\.7 % of its way: its frame is turned 5\\.0", {{Form::pose, ""}}}},
      {"counter_wraps", {""}},
      {"no_direction", {"only ever grow"}},
      {"exchanged", {"exchanged|swapped|backwards|upside down"}},
      {"misread", {""}},
      {"parts", {"a turn comes in 4 messages"}},
      {"wandering_head", {"one angle_increment"}},
      {"phantom", {"exactly 2.9 m"}}};
  return all;
}

/// Names of joints and frames are told by ROS recordings only:
/// tests/unit/proto/recording/ros_publishers_test.cpp.
bool is_tried_with_bags(const std::string& fault, Form form) {
  return fault == "several_sources" && form != Form::scan;
}

struct Outcome {
  Calibration calibration;
  std::string text;  ///< of the refusal, and of whatever was left out or put right
};

Outcome solved(const Recording& recording) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "drive.jsonl";
  EXPECT_TRUE(write_recording_jsonl(recording, path));
  Outcome outcome;
  const auto read = read_recording(path);
  if (!read) {
    outcome.text = read.error().text();
    return outcome;
  }
  outcome.calibration = calib::solve({&read.value(), 1}, {});
  for (const std::string& reason : outcome.calibration.reasons) outcome.text += reason + "\n";
  for (const Discarded& one : outcome.calibration.discarded)
    outcome.text += one.what + ": " + one.reason + "\n";
  for (const Repair& one : outcome.calibration.repairs)
    outcome.text += one.what + ": " + one.chosen + ", " + one.reason + "\n";
  return outcome;
}

void expect_right_lengths(const Outcome& outcome) {
  EXPECT_NE(outcome.calibration.verdict, Verdict::refused) << outcome.text;
  const sim::Geometry& truth = drive().truth;
  const auto expect_near = [&](const char* name, double value) {
    EXPECT_NEAR(outcome.calibration.parameter(name).value_or(0.0), value, kRight * value) << name << "\n"
                                                                                          << outcome.text;
  };
  expect_near("left_wheel_diameter", truth.left_diameter);
  expect_near("right_wheel_diameter", truth.right_diameter);
  expect_near("track_width", truth.track_width);
}

class FrontDoor : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] static Form form() { return static_cast<Form>(GetParam()); }
};

TEST_P(FrontDoor, says_nothing_of_a_sound_recording) {
  const Outcome outcome = solved(told_as(drive(), form()));
  expect_right_lengths(outcome);
  EXPECT_TRUE(outcome.calibration.repairs.empty()) << outcome.text;
  for (const auto& [name, one] : words()) {
    if (one.of(form()).empty()) continue;
    EXPECT_THAT(outcome.text, ::testing::Not(ContainsRegex(one.of(form())))) << name;
  }
}

TEST_P(FrontDoor, tells_or_mends_every_fault_that_the_form_can_have) {
  for (const auto& fault : calib::ingest::faults()) {
    const auto& cell = fault.cells.at(GetParam());
    SCOPED_TRACE(std::string(fault.name) + " of " + name_of(form()));
    if (cell.answer == Answer::cannot) {
      EXPECT_STRNE(cell.words, "");
      continue;
    }
    if (is_tried_with_bags(fault.name, form())) continue;
    const auto make = makers().find(fault.name);
    const auto says = words().find(fault.name);
    if (make == makers().end() || says == words().end()) {
      ADD_FAILURE() << "nothing makes this fault";
      continue;
    }
    Recording recording = told_as(drive(), form());
    make->second(recording, form(), {});
    const Outcome outcome = solved(recording);
    EXPECT_THAT(outcome.text, ContainsRegex(says->second.of(form())));
    if (cell.answer == Answer::mended) {
      expect_right_lengths(outcome);
    } else if (cell.answer == Answer::told) {
      EXPECT_EQ(outcome.calibration.verdict, Verdict::refused) << outcome.text;
    }
    // Never a wrong calibration: what is not refused is right.
    if (outcome.calibration.verdict != Verdict::refused) expect_right_lengths(outcome);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, FrontDoor, ::testing::Range<std::size_t>(0, calib::ingest::kForms),
                         [](const auto& one) { return std::string(name_of(static_cast<Form>(one.param))); });

}  // namespace
}  // namespace odomcalib::front_door_test
