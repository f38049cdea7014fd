// No motion tells how long the lidar's metre is: the stated absolute deviation covers it, and a tape puts it
// right.
// ODOMCALIB_CAMPAIGN=40 simulates so many lidars instead of a few.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>

#include "calib/ingest/settings.hpp"
#include "calib/solve.hpp"
#include "proto/calibration/scale.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::metre_test {
namespace {

constexpr unsigned kSeed = 61000;
constexpr double kOfTwoMetres = 0.5e-3;  // a tape read to 1 mm in 2 m

int campaign_size(int usual) {
  const char* size = std::getenv("ODOMCALIB_CAMPAIGN");
  return size != nullptr ? std::stoi(size) : usual;
}

struct Drawn {
  Recording recording;
  sim::Geometry truth;
};

/// A robot whose lidar's ranges are too long by this factor.
Drawn with_scale_error(unsigned robot, double factor) {
  sim::SimulationConfig config = sim::standard_config(robot);
  config.duration = 110.0;
  auto run = sim::simulate_recording(config, sim::random_drive(config.nominal, robot));
  for (Scan& scan : run.recording.scans)
    for (float& range : scan.ranges) range = static_cast<float>(range * factor);
  return {std::move(run.recording), run.truth};
}

struct Deviation {
  double error, std;
};

/// Errors of wheels and track against the truth, relative, with the absolute deviations.
std::vector<Deviation> deviations(const Calibration& found, const sim::Geometry& truth) {
  const auto& scale = found.scale;
  EXPECT_TRUE(scale);
  std::vector<Deviation> all;
  for (const auto& [name, quantity] : found.parameters) {
    const double own = name == "left_wheel_diameter"    ? truth.left_diameter
                       : name == "right_wheel_diameter" ? truth.right_diameter
                       : name == "track_width"          ? truth.track_width
                                                        : 0.0;
    if (own > 0.0)
      all.push_back({quantity.value / own - 1.0, absolute_deviation(quantity, scale.value()) / own});
  }
  EXPECT_EQ(all.size(), 3U);
  return all;
}

TEST(Metre, of_the_lidar_is_covered_by_the_absolute_deviation) {
  const int lidars = campaign_size(3);
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> error(0.0, calib::ingest::settings::kLidarScale);
  int covered = 0;
  for (int lidar = 0; lidar < lidars; ++lidar) {
    const Drawn drawn = with_scale_error(kSeed + static_cast<unsigned>(lidar), 1.0 + error(engine));
    const Calibration found = calib::solve({&drawn.recording, 1}, {});
    bool all = true;
    for (const Deviation& one : deviations(found, drawn.truth))
      all = all && std::abs(one.error) < 1.96 * one.std;
    covered += all ? 1 : 0;
  }
  std::cout << covered << " of " << lidars << " lidars covered, seed " << kSeed << "\n";
  // 38 of 40 are expected; fewer than 34 in one of a hundred campaigns.
  EXPECT_GE(covered, lidars - 2 - lidars / 10);
}

TEST(Metre, is_right_with_a_tape) {
  const int lidars = campaign_size(2);
  std::mt19937 engine(kSeed + 1);
  std::normal_distribution<double> error(0.0, calib::ingest::settings::kLidarScale),
      reading(0.0, kOfTwoMetres);
  int right = 0;
  for (int lidar = 0; lidar < lidars; ++lidar) {
    const double factor = 1.0 + error(engine);
    const Drawn drawn = with_scale_error(kSeed + static_cast<unsigned>(lidar), factor);
    const Scale tape{(1.0 + reading(engine)) / factor, kOfTwoMetres, "tape"};
    const Calibration found = calib::solve({&drawn.recording, 1}, {.scale = tape});
    bool all = true;
    for (const Deviation& one : deviations(found, drawn.truth)) {
      EXPECT_LT(one.std, 1e-3);
      all = all && std::abs(one.error) < 1e-3;
    }
    right += all ? 1 : 0;
  }
  std::cout << right << " of " << lidars << " within 0.1 %, seed " << kSeed + 1 << "\n";
  EXPECT_GE(right, lidars - 1 - lidars / 10) << "two deviations of the reading";
}

TEST(Metre, of_a_stated_scale_changes_lengths_and_no_ratio) {
  const Drawn drawn = with_scale_error(kSeed, 1.0);
  const Calibration plain = calib::solve({&drawn.recording, 1}, {});
  const Calibration scaled = calib::solve({&drawn.recording, 1}, {.scale = Scale{1.02, 0.001, "stated"}});
  ASSERT_FALSE(plain.parameters.empty());
  for (const auto& [name, quantity] : plain.parameters) {
    const double value = scaled.parameter(name).value_or(0.0);
    const double expected = quantity.unit == "m" ? 1.02 * quantity.value : quantity.value;
    EXPECT_NEAR(value, expected, 0.5 * quantity.std) << name;
  }
}

}  // namespace
}  // namespace odomcalib::metre_test
