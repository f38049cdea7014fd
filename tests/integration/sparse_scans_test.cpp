// Real and simulated vacuum robots whose scans are nearly empty: what is accepted is right, what is refused
// is refused for what is so. The files are not part of the repository.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calib/solve.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/recording/recording.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::sparse_scans_test {
namespace {

enum class Robot { simulated, real };

enum class Answer {
  lengths,    ///< accepted, with warnings or without
  either,     ///< so near the border that it may as well be refused
  too_empty,  ///< refused: too few readings, pairs or walls
};

struct Drive {
  const char* file;
  Robot robot;
  Answer answer;
};

std::ostream& operator<<(std::ostream& out, const Drive& drive) { return out << drive.file; }

constexpr double kWheel_m = 0.0762, kTrack_m = 0.248;  ///< nominal

/// Lengths of the simulated robots: they make their odometry that of the simulator.
constexpr double kSimulatedWheel_m = 0.070, kSimulatedTrack_m = 0.235;

/// Ratios to nominal, and delays, that an independent scan matching gave of the real ones.
constexpr double kLeastRatio = 0.95, kMostRatio = 1.05;
constexpr double kLeastLag_s = 0.31, kMostLag_s = 0.38;

class SparseScans : public ::testing::TestWithParam<Drive> {
 protected:
  static Calibration solved(const Drive& drive) {
    const RobotDescription robot{kWheel_m, kWheel_m, kTrack_m, 0.0, std::array{-0.1, 0.0, 3.14159}, "", ""};
    const TopicChoices topics = {{"scan", "/scan", {}}};
    const auto recording = read_recording(test_support::shared_data("neato") / drive.file, &robot, topics);
    EXPECT_TRUE(recording.ok()) << (recording.ok() ? "" : recording.error().text());
    return recording.ok() ? calib::solve({&recording.value(), 1}, {}) : Calibration{};
  }
};

std::string text_of(const Calibration& calibration) {
  std::string text;
  for (const std::string& reason : calibration.reasons) text += reason + "\n";
  return text;
}

/// Deviation of a length with that of the metre it is measured by.
double deviation(const Calibration& calibration, const Quantity& length) {
  const auto& scale = calibration.scale;
  return std::hypot(length.std, scale ? scale->std * length.value : 0.0);
}

void expect_right(const Calibration& calibration, Robot robot) {
  for (const auto& [name, quantity] : calibration.parameters) {
    if (name.starts_with("lidar_")) continue;
    const bool is_track = name == "track_width";
    const double nominal = is_track ? kTrack_m : kWheel_m;
    const double truth = is_track ? kSimulatedTrack_m : kSimulatedWheel_m;
    const double low = robot == Robot::real ? kLeastRatio * nominal : truth;
    const double high = robot == Robot::real ? kMostRatio * nominal : truth;
    const double reach = 3.0 * deviation(calibration, quantity);
    EXPECT_GT(quantity.value, low - reach) << name;
    EXPECT_LT(quantity.value, high + reach) << name;
  }
  if (robot == Robot::simulated) return;
  for (const EffectResult& effect : calibration.effects)
    for (const auto& [name, quantity] : effect.parameters)
      if (effect.name == "time_offset" && name == "offset") {
        EXPECT_GT(quantity.value, kLeastLag_s - 3.0 * quantity.std);
        EXPECT_LT(quantity.value, kMostLag_s + 3.0 * quantity.std);
      }
}

TEST_P(SparseScans, are_calibrated_rightly_or_refused_for_what_is_so) {
  ODOMCALIB_NEEDS_SHARED("neato");
  const Drive& drive = GetParam();
  const Calibration calibration = solved(drive);
  const std::string text = text_of(calibration);
  const bool is_accepted = calibration.verdict != Verdict::refused;
  if (drive.answer != Answer::either) {
    EXPECT_EQ(is_accepted, drive.answer == Answer::lengths) << text;
  }
  if (is_accepted) expect_right(calibration, drive.robot);
  for (const char* accusation : {"exchanged", "backwards", "swapped", "upside down", "looks elsewhere",
                                 "ticks per revolution", "clock", "gear", "angle_increment"})
    EXPECT_EQ(text.find(accusation), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(Neato, SparseScans,
                         ::testing::Values(Drive{"robot-c2.bag", Robot::real, Answer::lengths},
                                           Drive{"robot-c4.bag", Robot::real, Answer::lengths},
                                           Drive{"robot-d3.db3", Robot::real, Answer::too_empty},
                                           Drive{"robot-e2.bag", Robot::simulated, Answer::too_empty},
                                           Drive{"robot-e3.bag", Robot::simulated, Answer::too_empty},
                                           Drive{"robot-e4.bag", Robot::simulated, Answer::either},
                                           Drive{"robot-e5.bag", Robot::simulated, Answer::lengths},
                                           Drive{"robot-e6.bag", Robot::simulated, Answer::lengths},
                                           Drive{"robot-h1.bag", Robot::simulated, Answer::too_empty},
                                           Drive{"robot-h2.bag", Robot::simulated, Answer::too_empty},
                                           Drive{"robot-h4.bag", Robot::simulated, Answer::lengths},
                                           Drive{"robot-i1.bag", Robot::simulated, Answer::too_empty},
                                           Drive{"robot-i2.bag", Robot::simulated, Answer::lengths},
                                           Drive{"robot-i4.bag", Robot::simulated, Answer::lengths},
                                           Drive{"robot-j2.db3", Robot::real, Answer::lengths},
                                           Drive{"robot-k2.db3", Robot::real, Answer::lengths}),
                         [](const auto& drive) { return std::string(drive.param.file).substr(6, 2); });

}  // namespace
}  // namespace odomcalib::sparse_scans_test
