// Remedies that a refusal names for a unit are carried out to the letter, with the numbers that it prints:
// the recording is then calibrated rightly.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <regex>

#include "calib/solve.hpp"
#include "proto/recording/recording.hpp"
#include "tests/integration/recording_faults.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::front_door_remedies_test {
namespace {

using recording_faults::Form;

// Relative error of a length by a factor that was printed with six digits; the drive determines lengths to
// 0.0005.
constexpr double kRight = 0.002;

const sim::SimulatedRun& drive() {
  static const sim::SimulatedRun run = [] {
    sim::SimulationConfig config = sim::standard_config(23);
    config.duration = 110.0;
    return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
  }();
  return run;
}

using Scale = std::function<void(Recording& recording, double factor)>;

void scale_wheels(Recording& r, double factor) {
  for (auto& sample : r.wheels) sample.left *= factor, sample.right *= factor;
}

void scale_speeds(Recording& r, double factor) {
  for (auto& sample : r.wheel_speeds) sample.left *= factor, sample.right *= factor;
}

void scale_odometry(Recording& r, double factor) {
  for (auto& pose : r.odometry) pose.x *= factor, pose.y *= factor;
}

void scale_poses(Recording& r, double factor) {
  for (auto& pose : r.poses) pose.x *= factor, pose.y *= factor;
}

void scale_ranges(Recording& r, double factor) {
  for (Scan& scan : r.scans) {
    for (float& range : scan.ranges) range *= static_cast<float>(factor);
    scan.range_min *= factor, scan.range_max *= factor;
  }
}

void scale_yaws(Recording& r, double factor) {
  for (auto& pose : r.odometry) pose.yaw *= factor;
  for (auto& pose : r.poses) pose.yaw *= factor;
}

void set_resolution(Recording& r, double value) { r.robot.ticks_per_rev = value; }

void scale_counts(Recording& r, double factor) {
  for (auto& tick : r.ticks) {
    tick.left = std::llround(static_cast<double>(tick.left) * factor);
    tick.right = std::llround(static_cast<double>(tick.right) * factor);
  }
}

struct Mistake {
  const char* name;
  Form form;
  Scale make;
  double by;
  const char* word;    ///< by which the unit is named; empty where only a factor can be told
  const char* remedy;  ///< its last group is the number to type
  Scale follow;
};

constexpr double kPi = std::numbers::pi;
constexpr const char* kMultiply = "multiply (them|x and y of the poses) by ([0-9.e+-]+)";
constexpr const char* kResolution = "set (ticks_per_rev) to ([0-9.e+-]+) instead";

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all = {
      {"counts_of_four_edges", Form::ticks, scale_counts, 4.0, "all four", kResolution, set_resolution},
      {"counts_per_radian", Form::ticks, scale_counts, 2.0 * kPi, "per radian", kResolution, set_resolution},
      {"angles_in_degrees", Form::wheels, scale_wheels, 180.0 / kPi, "degrees", kMultiply, scale_wheels},
      {"angles_in_turns", Form::wheels, scale_wheels, 0.5 / kPi, "turns", kMultiply, scale_wheels},
      {"angles_in_metres", Form::wheels, scale_wheels, 0.075, "metres", kMultiply, scale_wheels},
      {"speeds_in_rpm", Form::wheel_speeds, scale_speeds, 30.0 / kPi, "rpm", kMultiply, scale_speeds},
      {"speeds_in_tenths_of_rpm", Form::wheel_speeds, scale_speeds, 300.0 / kPi, "rpm times 10", kMultiply,
       scale_speeds},
      {"speeds_in_degrees", Form::wheel_speeds, scale_speeds, 180.0 / kPi, "degrees", kMultiply,
       scale_speeds},
      {"odometry_in_cm", Form::odometry, scale_odometry, 100.0, "centimetres", kMultiply, scale_odometry},
      {"odometry_in_mm", Form::odometry, scale_odometry, 1000.0, "millimetres", kMultiply, scale_odometry},
      {"odometry_in_feet", Form::odometry, scale_odometry, 1.0 / 0.3048, "feet", kMultiply, scale_odometry},
      {"poses_in_mm", Form::pose, scale_poses, 1000.0, "millimetres", kMultiply, scale_poses},
      {"poses_in_inches", Form::pose, scale_poses, 1.0 / 0.0254, "inches", kMultiply, scale_poses},
      {"ranges_in_mm", Form::scan, scale_ranges, 1000.0, "millimetres",
       "multiply (ranges, range_min and range_max) by ([0-9.e+-]+)", scale_ranges},
      {"ranges_twice", Form::scan, scale_ranges, 2.0, "not halved",
       "multiply (ranges and their limits) by ([0-9.e+-]+)", scale_ranges},
      {"yaw_of_odometry_in_degrees", Form::odometry, scale_yaws, 180.0 / kPi, "degrees",
       "multiply yaw by (pi) / ([0-9]+)", [](Recording& r, double degrees) { scale_yaws(r, kPi / degrees); }},
      {"yaw_of_poses_in_degrees", Form::pose, scale_yaws, 180.0 / kPi, "degrees",
       "multiply yaw by (pi) / ([0-9]+)",
       [](Recording& r, double degrees) { scale_yaws(r, kPi / degrees); }}};
  return all;
}

/// Through a file, as a user would: what is no count is turned into counts by the reader.
Calibration solved(const Recording& recording) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "drive.jsonl";
  EXPECT_TRUE(write_recording_jsonl(recording, path));
  const auto read = read_recording(path);
  if (!read) {
    ADD_FAILURE() << read.error().text();
    return {};
  }
  calib::SolveOptions base;
  base.effects = {"none"};
  return calib::solve({&read.value(), 1}, base);
}

std::string text_of(const Calibration& calibration) {
  std::string text;
  for (const std::string& reason : calibration.reasons) text += reason + "\n";
  return text;
}

class Remedy : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Remedy, of_a_unit_followed_to_the_letter_leads_to_right_lengths) {
  const Mistake& mistake = mistakes()[GetParam()];
  Recording recording = recording_faults::told_as(drive(), mistake.form);
  mistake.make(recording, mistake.by);
  const Calibration wrong = solved(recording);
  const std::string said = text_of(wrong);
  EXPECT_EQ(wrong.verdict, Verdict::refused) << said;
  EXPECT_NE(said.find(mistake.word), std::string::npos) << said;
  if (mistake.form != Form::ticks) {
    EXPECT_EQ(said.find("ticks_per_rev"), std::string::npos) << said;
  }
  std::smatch found;
  ASSERT_TRUE(std::regex_search(said, found, std::regex(mistake.remedy))) << said;

  mistake.follow(recording, std::stod(found[2]));
  const Calibration right = solved(recording);
  EXPECT_NE(right.verdict, Verdict::refused) << text_of(right);
  const sim::Geometry& truth = drive().truth;
  const auto expect_near = [&](const char* name, double value) {
    EXPECT_NEAR(right.parameter(name).value_or(0.0), value, kRight * value) << name << " after: " << said;
  };
  expect_near("left_wheel_diameter", truth.left_diameter);
  expect_near("right_wheel_diameter", truth.right_diameter);
  expect_near("track_width", truth.track_width);
}

INSTANTIATE_TEST_SUITE_P(Units, Remedy, ::testing::Range<std::size_t>(0, mistakes().size()),
                         [](const auto& one) { return std::string(mistakes()[one.param].name); });

}  // namespace
}  // namespace odomcalib::front_door_remedies_test
