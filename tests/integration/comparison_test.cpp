// Two drives of one simulated robot, solved one by one: what differs between the two calibrations is chance,
// and the deviations of the differences have to say so. Six pairs; two hundred with ODOMCALIB_LONG
// (docs/evidence/comparison.md).
#include "calib/comparison/difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "calib/solve.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::comparison_test {
namespace {

using calib::comparison::Change;
using calib::comparison::Difference;

constexpr double kDrive_s = 120.0;
constexpr double kDeviations = 3.0;

/// Another drive of the robot that the seed draws: other noise, other starting place on the same floor.
/// @param worn m, that both wheels have lost in diameter
Calibration calibrated(std::uint64_t robot, std::uint64_t drive, double worn) {
  sim::SimulationConfig config = sim::standard_config(robot);
  config.truth.left_diameter -= worn;
  config.truth.right_diameter -= worn;
  config.duration = kDrive_s;
  config.seed = 1000 * robot + drive;
  sim::SimulatedRun run = sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
  return calib::solve({&run.recording, 1}, {});
}

struct Coverage {
  int pairs = 0, refused = 0, changes = 0, effects = 0, compared = 0, within = 0;
  double squares = 0.0;
  std::map<std::string, int> beyond;

  void add(const Calibration& first, const Calibration& second) {
    ++pairs;
    if (first.verdict == Verdict::refused || second.verdict == Verdict::refused) {
      ++refused;
      return;
    }
    const Difference found = calib::comparison::difference(first, second);
    changes += found.is_change() ? 1 : 0;
    effects += found.came.empty() && found.went.empty() ? 0 : 1;
    for (const Change& one : found.parameters) {
      ++compared;
      squares += one.deviations() * one.deviations();
      if (std::abs(one.deviations()) <= kDeviations)
        ++within;
      else
        ++beyond[one.name];
    }
  }
  [[nodiscard]] double share() const { return static_cast<double>(within) / compared; }
  void print() const {
    std::printf(
        "%d pairs, %d refused, %d called a change, %d with effects that came or went; %d of %d differences "
        "within three deviations (%.2f %%), RMS %.2f deviations\n",
        pairs, refused, changes, effects, within, compared, 100.0 * share(), std::sqrt(squares / compared));
    for (const auto& [name, count] : beyond) std::printf("  beyond: %d x %s\n", count, name.c_str());
  }
};

TEST(Comparison, of_two_drives_of_one_robot_covers_their_differences) {
  const std::uint64_t pairs = test_support::long_tests() ? 200 : 6;
  Coverage coverage;
  for (std::uint64_t robot = 1; robot <= pairs; ++robot)
    coverage.add(calibrated(robot, 1, 0.0), calibrated(robot, 2, 0.0));
  coverage.print();
  EXPECT_EQ(coverage.refused, 0);
  EXPECT_GE(coverage.share(), 0.97);
  EXPECT_LE(coverage.changes, std::max(1, static_cast<int>(pairs) / 20));
}

TEST(Comparison, of_a_robot_with_worn_tyres_says_what_changed) {
  constexpr double kWorn = 0.001;
  const Difference found = calib::comparison::difference(calibrated(1, 1, 0.0), calibrated(1, 3, kWorn));
  EXPECT_TRUE(found.is_change());
  for (const Change& one : found.parameters) {
    const bool worn = one.name.ends_with("wheel_diameter");
    EXPECT_EQ(one.is_change(), worn) << one.name << " " << one.deviations();
    EXPECT_NEAR(one.difference(), worn ? -kWorn : 0.0, kDeviations * one.std) << one.name;
  }
}

}  // namespace
}  // namespace odomcalib::comparison_test
