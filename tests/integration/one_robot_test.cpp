// Several recordings: of one robot they are one, of two robots, or of one whose tyre was changed in between,
// they are told apart, by name and in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib {
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
  EXPECT_TRUE(result.extensions.contains("homogeneity"));
  EXPECT_TRUE(result.extensions.contains("recordings"));
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
    EXPECT_TRUE(holds(reasons_of(result), "do not agree on one robot: in drive2.jsonl"))
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

// Outvoted by sound ones it would be left out pair by pair.
TEST(OneRobot, with_exchanged_counts_in_one_recording_is_refused_by_name) {
  std::vector<Recording> recordings = {recorded(9, 1), recorded(9, 2)};
  for (TickSample& tick : recordings[1].ticks) std::swap(tick.left, tick.right);
  const Calibration result = calib::solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  EXPECT_TRUE(holds(reasons_of(result), "drive2.jsonl: ") && holds(reasons_of(result), "exchanged"))
      << reasons_of(result);
}

}  // namespace
}  // namespace odomcalib
