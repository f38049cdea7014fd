// Several recordings: of one robot they are one, of two robots, or of one whose tyre was changed in between,
// they are told apart, by name and in any order.
// ODOMCALIB_CAMPAIGN=100 counts over a hundred of each kind instead of a few; seeds are the numbers of the
// pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::one_robot_test {
namespace {

constexpr double kDuration = 110.0;  // s

/// @param robot seed of its lengths
/// @param noise seed of the drive and of every noise
Recording recorded(std::uint64_t robot, std::uint64_t noise, double left_factor = 1.0) {
  sim::SimulationConfig config = sim::standard_config(robot);
  config.duration = kDuration;
  config.seed = noise;
  config.truth.left_diameter *= left_factor;
  Recording recording = sim::simulate_recording(config, sim::random_drive(config.nominal, noise)).recording;
  recording.name = "drive" + std::to_string(noise) + ".jsonl";
  recording.robot.robot_id = "robot-" + std::to_string(robot);
  return recording;
}

std::string reasons_of(const Calibration& result) {
  std::string all;
  for (const std::string& reason : result.reasons) all += reason + "\n";
  return all;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(OneRobot, is_seen_in_recordings_of_one_robot) {
  const std::vector<Recording> recordings = {recorded(9, 1), recorded(9, 2), recorded(9, 3)};
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::accepted) << reasons_of(result);
  EXPECT_TRUE(result.homogeneity);
  EXPECT_FALSE(result.recordings.empty());
}

TEST(OneRobot, of_one_recording_is_not_tested_and_the_recording_is_named) {
  const std::vector<Recording> recordings = {recorded(9, 1)};
  const Calibration result = calib::solve(recordings, {});
  EXPECT_FALSE(result.homogeneity);
  ASSERT_EQ(result.recordings.size(), 1U);
  EXPECT_EQ(result.recordings.front().file, recordings.front().name);
  EXPECT_FALSE(result.recordings.front().parameters);
}

TEST(OneRobot, is_not_assumed_where_recordings_name_two) {
  const std::vector<Recording> recordings = {recorded(9, 1), recorded(5, 2)};
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  EXPECT_TRUE(holds(reasons_of(result), "robot-5") && holds(reasons_of(result), "--same-robot"))
      << reasons_of(result);
}

TEST(OneRobot, is_not_seen_in_recordings_of_two_without_a_name) {
  for (const bool turned : {false, true}) {
    std::vector<Recording> recordings = {recorded(9, 1), recorded(5, 2)};
    if (turned) std::swap(recordings[0], recordings[1]);
    const Calibration result = calib::solve(recordings, {.same_robot = true});
    EXPECT_EQ(result.verdict, Verdict::refused);
    EXPECT_TRUE(holds(reasons_of(result), "do not agree on one robot: ") &&
                holds(reasons_of(result), "in drive2.jsonl than in drive1.jsonl"))
        << reasons_of(result);
  }
}

TEST(OneRobot, with_another_tyre_in_one_recording_is_told_by_name) {
  std::vector<Recording> recordings;
  for (std::uint64_t noise = 1; noise <= 5; ++noise)
    recordings.push_back(recorded(9, noise, noise == 3 ? 1.003 : 1.0));
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::accepted_with_warnings);
  EXPECT_TRUE(holds(reasons_of(result), "in drive3.jsonl left_wheel_diameter is")) << reasons_of(result);
  std::rotate(recordings.begin(), recordings.begin() + 2, recordings.end());
  const Calibration turned = calib::solve(recordings, {});
  EXPECT_TRUE(holds(reasons_of(turned), "in drive3.jsonl left_wheel_diameter is")) << reasons_of(turned);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& [name, quantity] = result.parameters[k];
    EXPECT_NEAR(quantity.value, turned.parameter(name).value_or(0.0), 0.1 * quantity.std) << name;
  }
}

/// As with wheels of other sizes: counts are what the robot recorded of the same motion.
Recording with_wheels(Recording recording, double left_factor, double right_factor) {
  for (TickSample& tick : recording.ticks) {
    tick.left = std::llround(static_cast<double>(tick.left) / left_factor);
    tick.right = std::llround(static_cast<double>(tick.right) / right_factor);
  }
  return recording;
}

/// Parts of one drive of so many seconds each, with their own names.
std::vector<Recording> parts_of_a_drive(std::uint64_t robot, std::size_t parts, double seconds) {
  sim::SimulationConfig config = sim::standard_config(robot);
  config.duration = seconds * static_cast<double>(parts);
  config.seed = robot;
  const Recording whole = sim::simulate_recording(config, sim::random_drive(config.nominal, robot)).recording;
  std::vector<Recording> all(parts, whole);
  for (std::size_t k = 0; k < parts; ++k) {
    const double begin = whole.ticks.front().t + seconds * static_cast<double>(k);
    const auto is_elsewhere = [&](const auto& sample) {
      return sample.t < begin || sample.t >= begin + seconds;
    };
    std::erase_if(all[k].ticks, is_elsewhere);
    std::erase_if(all[k].scans, is_elsewhere);
    all[k].name = "part" + std::to_string(k) + ".jsonl";
  }
  return all;
}

TEST(OneRobot, with_another_tyre_in_one_part_of_a_drive_is_told_by_name) {
  for (const std::size_t odd : {0U, 1U}) {
    std::vector<Recording> parts = parts_of_a_drive(9, 3, 60.0);
    parts[odd] = with_wheels(parts[odd], 1.015, 1.0);
    const Calibration result = calib::solve(parts, {});
    EXPECT_EQ(result.verdict, Verdict::refused);
    EXPECT_TRUE(holds(reasons_of(result), "in " + parts[odd].name + " left_wheel_diameter is 1.") &&
                holds(reasons_of(result), "larger than in the others"))
        << reasons_of(result);
  }
}

// A curve over speed may stand for the tyre where one recording is faster than the other.
TEST(OneRobot, with_another_tyre_in_one_of_two_recordings_is_told_in_any_order) {
  std::vector<Recording> parts = parts_of_a_drive(9, 2, 80.0);
  parts[1] = with_wheels(parts[1], 1.015, 1.0);
  for (const bool turned : {false, true}) {
    if (turned) std::swap(parts[0], parts[1]);
    const Calibration result = calib::solve(parts, {});
    EXPECT_EQ(result.verdict, Verdict::refused);
    EXPECT_TRUE(holds(reasons_of(result), "left_wheel_diameter is 1.") &&
                holds(reasons_of(result), "larger in part1.jsonl than in part0.jsonl"))
        << reasons_of(result);
  }
}

/// Whether every length is refused, or uncertain enough to hold for both sets of tyres.
bool is_honest(const Calibration& result, const sim::Geometry& truth, double factor) {
  if (result.verdict == Verdict::refused) return true;
  const std::array<double, 3> lengths = {truth.left_diameter, truth.right_diameter, truth.track_width};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto& quantity = result.parameters[k].second;
    for (const double size : {lengths.at(k), (k < 2 ? factor : 1.0) * lengths.at(k)})
      if (std::abs(quantity.value - size) > 3.0 * quantity.std) return false;
  }
  return true;
}

TEST(OneRobot, with_two_other_tyres_in_one_of_two_recordings_is_never_exact) {
  for (const double factor : {1.003, 1.01}) {
    std::vector<Recording> parts = parts_of_a_drive(9, 2, 80.0);
    parts[1] = with_wheels(parts[1], factor, factor);
    const Calibration result = calib::solve(parts, {});
    EXPECT_NE(result.verdict, Verdict::accepted);
    EXPECT_TRUE(is_honest(result, sim::standard_config(9).truth, factor)) << factor << "\n"
                                                                          << reasons_of(result);
  }
}

// Outvoted by sound ones it would be left out pair by pair.
TEST(OneRobot, with_exchanged_counts_in_one_recording_is_refused_by_name) {
  std::vector<Recording> recordings = {recorded(9, 1), recorded(9, 2)};
  for (TickSample& tick : recordings[1].ticks) std::swap(tick.left, tick.right);
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  EXPECT_TRUE(holds(reasons_of(result), "drive2.jsonl: ") && holds(reasons_of(result), "exchanged"))
      << reasons_of(result);
}

/// As a sensor stamps them whose clock is late by so much, and runs so much faster.
Recording with_clock(Recording recording, double late, double fast) {
  for (Scan& scan : recording.scans) scan.t += late + fast * (scan.t - 0.5 * kDuration);
  return recording;
}

/// s, standard deviation between the clocks of the recordings as the result states it; 0: they are one.
double clocks_apart(const Calibration& result) {
  return result.stamps ? result.stamps->clocks.value_or(0.0) : 0.0;
}

TEST(RecordingClocks, that_differ_are_each_its_own) {
  constexpr std::array<double, 5> kLate = {-0.040, 0.025, 0.0, 0.012, -0.015};  // s
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < kLate.size(); ++i)
    recordings.push_back(with_clock(recorded(9, i + 1), kLate.at(i), i == 1 ? 5e-4 : 0.0));
  const Calibration result = calib::solve(recordings, {});
  EXPECT_NE(result.verdict, Verdict::refused) << reasons_of(result);
  EXPECT_NEAR(clocks_apart(result), 0.026, 0.006);
  EXPECT_TRUE(holds(reasons_of(result), "the clocks of the recordings differ by")) << reasons_of(result);
  const sim::Geometry truth = sim::standard_config(9).truth;
  const std::array<double, 3> lengths = {truth.left_diameter, truth.right_diameter, truth.track_width};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto& [name, quantity] = result.parameters[k];
    EXPECT_NEAR(quantity.value, lengths.at(k), 3.0 * quantity.std) << name;
    EXPECT_LT(quantity.std, 3e-4 * quantity.value) << name;
  }
}

TEST(RecordingClocks, that_are_late_alike_are_one) {
  std::vector<Recording> recordings;
  for (std::uint64_t noise = 1; noise <= 3; ++noise)
    recordings.push_back(with_clock(recorded(9, noise), 0.030, 0.0));
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(clocks_apart(result), 0.0);
  EXPECT_TRUE(std::any_of(result.effects.begin(), result.effects.end(),
                          [](const EffectResult& effect) { return effect.name == "time_offset"; }));
}

constexpr std::uint64_t kCampaignSeed = 52000;  // robots and drives that no other test uses

std::uint64_t campaign_size(std::uint64_t usual) {
  const char* size = std::getenv("ODOMCALIB_CAMPAIGN");
  return size != nullptr ? std::stoull(size) : usual;
}

bool is_told_apart(const Calibration& result) {
  return holds(reasons_of(result), "do not agree on one robot");
}

/// Pairs of drives of which the second robot's number is that of the first and so much more.
std::uint64_t count_told_apart(std::uint64_t pairs, std::uint64_t apart) {
  std::uint64_t told = 0;
  for (std::uint64_t pair = 0; pair < pairs; ++pair) {
    const std::uint64_t robot = kCampaignSeed + 10 * pair;
    const std::vector<Recording> recordings = {recorded(robot, robot + 1),
                                               recorded(robot + apart, robot + 2)};
    const Calibration result = calib::solve(recordings, {.same_robot = true});
    const bool is_told = is_told_apart(result) || (apart != 0 && result.verdict == Verdict::refused);
    if (is_told) ++told;
    if (is_told == (apart == 0))
      std::cout << "robots " << robot << " and " << robot + apart << ": " << reasons_of(result) << "\n";
  }
  std::cout << told << " of " << pairs << " pairs told apart\n";
  return told;
}

TEST(OneRobotCampaign, tells_different_robots_apart) {
  const std::uint64_t pairs = campaign_size(3);
  EXPECT_EQ(count_told_apart(pairs, 5), pairs);
}

TEST(OneRobotCampaign, takes_one_robot_for_one) {
  const std::uint64_t pairs = campaign_size(3);
  EXPECT_LE(count_told_apart(pairs, 0), pairs / 100);
}

TEST(OneRobotCampaign, takes_one_clock_for_one) {
  const std::uint64_t sets = campaign_size(3);
  std::uint64_t apart = 0;
  for (std::uint64_t set = 0; set < sets; ++set) {
    const std::uint64_t robot = kCampaignSeed + 10 * set;
    std::vector<Recording> recordings;
    for (std::uint64_t drive = 1; drive <= 3; ++drive) recordings.push_back(recorded(robot, robot + drive));
    if (clocks_apart(calib::solve(recordings, {})) > 0.0) ++apart;
  }
  std::cout << apart << " of " << sets << " sets with clocks apart\n";
  EXPECT_LE(apart, sets / 50);
}

TEST(OneRobotCampaign, names_the_recording_with_another_tyre) {
  const std::uint64_t sets = campaign_size(1);
  std::uint64_t named = 0;
  for (std::uint64_t set = 0; set < sets; ++set) {
    const std::uint64_t robot = kCampaignSeed + 10 * set, odd = 1 + set % 5;
    std::vector<Recording> recordings;
    for (std::uint64_t drive = 1; drive <= 5; ++drive)
      recordings.push_back(recorded(robot, robot + drive, drive == odd ? 1.003 : 1.0));
    const Calibration result = calib::solve(recordings, {});
    if (holds(reasons_of(result), "in drive" + std::to_string(robot + odd) + ".jsonl left_wheel_diameter"))
      ++named;
    else
      std::cout << "robot " << robot << ", drive " << odd << ": " << reasons_of(result) << "\n";
  }
  std::cout << named << " of " << sets << " changed tyres named\n";
  EXPECT_GE(static_cast<double>(named), 0.95 * static_cast<double>(sets));
}

}  // namespace
}  // namespace odomcalib::one_robot_test
