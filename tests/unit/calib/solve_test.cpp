#include "calib/solve.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/odometry/predict.hpp"
#include "tests/unit/calib/room_scans.hpp"
#include "tests/unit/calib/shared_data.hpp"

namespace odomcalib::calib::solve_test {
namespace {

using odomcalib::test_support::shared_data;
using odomcalib::test_support::shared_files;

Recording load(const std::filesystem::path& path) {
  auto recording = read_recording(path);
  EXPECT_TRUE(recording.ok()) << (recording.ok() ? "" : recording.error().text());
  return recording.ok() ? std::move(recording).value() : Recording{};
}

Quantity quantity(const QuantityList& list, const std::string& name) {
  for (const auto& [key, value] : list)
    if (key == name) return value;
  ADD_FAILURE() << name << " is missing";
  return {};
}

/// Within three standard deviations, those of the reference and ours taken together.
void expect_agreement(const Quantity& ours, double reference, double reference_std, const std::string& name) {
  EXPECT_LT(std::abs(ours.value - reference), 3.0 * std::hypot(ours.std, reference_std))
      << name << " " << ours.value << " +- " << ours.std << " against " << reference << " +- "
      << reference_std;
}

TEST(Solve, SD_11_a_recording_without_scans_is_refused_with_the_cause) {
  Recording recording;
  recording.name = "no-lidar";
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  recording.ticks = {{0.0, 0, 0, 0}, {1.0, 100, 100, 0}};
  const Calibration result = solve({&recording, 1}, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(result.reasons[0].find("neither scans nor reference poses"), std::string::npos);
  EXPECT_TRUE(result.parameters.empty());
  ASSERT_EQ(result.data.size(), 1U) << "what was refused is told";
  EXPECT_EQ(result.data.front().name, "no-lidar");
  EXPECT_EQ(result.data.front().counts.front(), (std::pair<std::string, std::size_t>{"ticks", 2}));
}

// Recordings of readers that count from a second of the file, and of those that do not.
TEST(Solve, says_when_the_robot_was_driven_where_the_clock_tells_the_date) {
  Recording recording;
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  recording.ticks = {{0.0, 0, 0, 0}, {1.0, 100, 100, 0}};
  EXPECT_FALSE(solve({&recording, 1}, {}).driven) << "seconds since the start of a computer are no date";
  recording.time_zero = 1.6e9;
  const auto driven = solve({&recording, 1}, {}).driven;
  ASSERT_TRUE(driven);
  EXPECT_EQ(driven->begin, 1.6e9);
  EXPECT_EQ(driven->end, 1.6e9 + 1.0);
  std::array<Recording, 2> both{recording, recording};
  both[1].time_zero = 0.0;
  for (TickSample& sample : both[1].ticks) sample.t += 1.5e9;
  const auto earliest = solve(both, {}).driven;
  ASSERT_TRUE(earliest);
  EXPECT_EQ(earliest->begin, 1.5e9);
  EXPECT_EQ(earliest->end, 1.6e9 + 1.0);
}

TEST(Solve, S1_14_a_corridor_is_refused_as_a_place_that_scans_cannot_tell) {
  Recording recording;
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  constexpr double kSpeed = 0.2, kCountsPerMetre = 4096.0 / (math::kPi * 0.15);
  for (int k = 0; k <= 1500; ++k) {
    const auto counts = static_cast<std::int64_t>(std::lround(kSpeed * 0.02 * k * kCountsPerMetre));
    recording.ticks.push_back({0.02 * k, counts, counts, 0});
  }
  for (unsigned k = 0; k < 300; ++k) {
    recording.scans.push_back(odomcalib::test_support::scan_from(odomcalib::test_support::kCorridor,
                                                                 {kSpeed * 0.1 * k, 0.0, 0.0}, 0.01, k, 360));
    recording.scans.back().t = 0.1 * k;
  }
  const Calibration result = solve({&recording, 1}, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(
      result.reasons[0].find("pairs of scans leave one direction open; drive where the lidar sees walls"),
      std::string::npos)
      << result.reasons[0];
}

TEST(Solve, says_in_a_refusal_that_poses_have_replaced_the_scans) {
  Recording recording;
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  for (int k = 0; k < 300; ++k) recording.ticks.push_back({0.02 * k, 9L * k, 9L * k, 0});
  for (int k = 0; k < 8; ++k) recording.poses.push_back({0.1 * k, 0.01 * k, 0.0, 0.0});
  recording.scans.resize(60);
  for (std::size_t k = 0; k < 60; ++k) recording.scans[k].t = 0.1 * static_cast<double>(k);
  const Calibration result = solve({&recording, 1}, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  ASSERT_EQ(result.repairs.size(), 1U);
  EXPECT_EQ(result.repairs[0].reason.find("60 scans are not used: the poses are the reference"), 0U);
}

TEST(Solve, recordings_of_two_lidars_are_refused) {
  std::array<Recording, 2> recordings;
  for (Recording& recording : recordings) {
    recording.name = &recording == recordings.data() ? "drive1" : "drive2";
    recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
    for (int k = 0; k < 300; ++k) recording.ticks.push_back({0.02 * k, 9L * k, 9L * k, 0});
    for (unsigned k = 0; k < 60; ++k) {
      recording.scans.push_back(odomcalib::test_support::scan_from(odomcalib::test_support::kRoom,
                                                                   {0.01 * k, 0.0, 0.0}, 0.01, k, 360));
      recording.scans.back().t = 0.1 * k;
      recording.scans.back().sensor = recording.name == "drive1" ? "front" : "rear";
    }
  }
  const Calibration result = solve(recordings, {});
  EXPECT_EQ(result.verdict, Verdict::refused);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(result.reasons[0].find("its scans are of the sensor \"rear\", but those of drive1 of \"front\""),
            std::string::npos)
      << result.reasons[0];
  // A second one of the model would look the same: somebody has to say that it is the same one.
  const Calibration same = solve(recordings, {.same_lidar = true});
  ASSERT_FALSE(same.reasons.empty());
  EXPECT_EQ(same.reasons[0].find("its scans are of the sensor"), std::string::npos) << same.reasons[0];
  ASSERT_FALSE(same.repairs.empty());
  EXPECT_EQ(same.repairs[0].chosen, "of the sensor \"rear\", taken for \"front\"");
}

TEST(Solve, an_unknown_effect_is_refused_by_name) {
  Recording recording;
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  recording.ticks = {{0.0, 0, 0, 0}, {1.0, 100, 100, 0}};
  recording.poses = {{0.0, 0, 0, 0}, {1.0, 0.01, 0, 0}};
  const Calibration result = solve({&recording, 1}, {{"no_such_effect"}});
  EXPECT_EQ(result.verdict, Verdict::refused);
  EXPECT_NE(result.reasons[0].find("no_such_effect"), std::string::npos);
}

// Reference fits of the data set's README: six parameters and a delay; smoothed stamps, step 1.
TEST(Solve, mines_rover_agrees_with_the_reference_fit_including_the_delay) {
  ODOMCALIB_NEEDS_SHARED("mines-rover/exp1.jsonl.gz");
  const Recording recording = load(shared_data("mines-rover/exp1.jsonl.gz"));
  const Calibration result = solve({&recording, 1}, {{"time_offset"}});
  ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  expect_agreement(quantity(result.parameters, "left_wheel_diameter"), 0.1520, 0.0004, "left wheel diameter");
  expect_agreement(quantity(result.parameters, "right_wheel_diameter"), 0.1512, 0.0004,
                   "right wheel diameter");
  expect_agreement(quantity(result.parameters, "track_width"), 0.2968, 0.002, "track width");
  ASSERT_EQ(result.effects.size(), 1U);
  expect_agreement(quantity(result.effects[0].parameters, "offset"), 0.1532, 0.0008, "delay");
  EXPECT_FALSE(result.effects[0].aliases.empty()) << "an encoder that lags looks the same";
}

TEST(Solve, azos_wheelchair_agrees_with_the_reference_fit_including_the_delay) {
  ODOMCALIB_NEEDS_SHARED("azos-wheelchair/azos.jsonl.gz");
  const Recording recording = load(shared_data("azos-wheelchair/azos.jsonl.gz"));
  const Calibration result = solve({&recording, 1}, {{"time_offset"}});
  ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  // Step 1 with the delay fitted: 0.2398 and 0.2379 +- 0.0003 mm per tick, 2000 ticks per turn.
  expect_agreement(quantity(result.parameters, "left_wheel_diameter"), 0.15266, 0.0002,
                   "left wheel diameter");
  expect_agreement(quantity(result.parameters, "right_wheel_diameter"), 0.15145, 0.0002,
                   "right wheel diameter");
  expect_agreement(quantity(result.parameters, "track_width"), 0.577, 0.0011, "track width");
  expect_agreement(quantity(result.parameters, "lidar_x"), 0.689, 0.002, "lidar x");
  ASSERT_EQ(result.effects.size(), 1U);
  expect_agreement(quantity(result.effects[0].parameters, "offset"), 0.96 * 0.2, 0.01 * 0.2, "delay");
}

TEST(Solve, maebot_agrees_with_the_reference_fit) {
  ODOMCALIB_NEEDS_SHARED("maebot/empty.jsonl.gz");
  const Recording recording = load(shared_data("maebot/empty.jsonl.gz"));
  const Calibration result = solve({&recording, 1}, {{"time_offset"}});
  ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  expect_agreement(quantity(result.parameters, "left_wheel_diameter"), 0.03332, 0.00011,
                   "left wheel diameter");
  expect_agreement(quantity(result.parameters, "track_width"), 0.0837, 0.0003, "track width");
  expect_agreement(quantity(result.parameters, "lidar_x"), -0.0021, 0.0002, "lidar x");
}

// Where so few matches agree a term of the turn rate explains a part of what is left, and takes two per cent
// of the track with it.
TEST(Solve, a_gain_that_may_be_chance_moves_no_length) {
  ODOMCALIB_NEEDS_SHARED("maebot/a0.jsonl.gz");
  const Recording recording = load(shared_data("maebot/a0.jsonl.gz"));
  const Calibration result = solve({&recording, 1}, {});
  ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  EXPECT_FALSE(result.unexplained);
  const double of_empty_arena = 0.0837;
  const Quantity& track = quantity(result.parameters, "track_width");
  EXPECT_LT(std::abs(track.value - of_empty_arena), 3.0 * track.std);
}

struct EndError {
  double position = 0.0;  ///< mean, m
  double heading = 0.0;   ///< mean, rad
};

EndError mean_end_error(const std::string& kind, const Calibration& calibration) {
  EndError sum;
  const auto files = shared_files("optiodom", "-" + kind + "-");
  for (const auto& file : files) {
    const Recording recording = load(file);
    const auto path = odometry::predict(recording, calibration);
    const PoseSample& first = recording.poses.front();
    const PoseSample& last = recording.poses.back();
    const double dx = last.x - first.x;
    const double dy = last.y - first.y;
    const double x = std::cos(first.yaw) * dx + std::sin(first.yaw) * dy;
    const double y = -std::sin(first.yaw) * dx + std::cos(first.yaw) * dy;
    sum.position += std::hypot(path.back().x - x, path.back().y - y);
    sum.heading += std::abs(std::remainder(path.back().yaw - (last.yaw - first.yaw), 2.0 * M_PI));
  }
  const double n = static_cast<double>(files.size());
  return {sum.position / n, sum.heading / n};
}

/// @param every of how many one is taken
std::vector<Recording> optiodom(const std::string& kind, std::size_t every = 1) {
  std::vector<Recording> recordings;
  const auto files = shared_files("optiodom", "-" + kind + "-");
  for (std::size_t k = 0; k < files.size(); k += every) recordings.push_back(load(files[k]));
  return recordings;
}

/// End errors of the published least-squares fit of end poses on straight-spin only.
constexpr EndError kPublishedSquare{9.3e-3, 1.08 * M_PI / 180.0};
constexpr EndError kPublishedCircle{17.4e-3, 3.80 * M_PI / 180.0};

// Squares alone end 1 to 5 % farther off than the published fit's, circles 40 to 70 % nearer: the marker was
// taken there for the middle of the axle, a millimetre ahead of which it is found to sit.
TEST(Solve, optiodom_fitted_on_straight_and_spin_holds_on_squares_and_circles) {
  ODOMCALIB_NEEDS_SHARED("optiodom");
  const std::vector<Recording> recordings = optiodom("straight-spin");
  ASSERT_EQ(recordings.size(), 42U);
  for (const std::vector<std::string>& effects : {std::vector<std::string>{"none"}, {"auto"}}) {
    const Calibration result = solve(recordings, {effects});
    ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
    const EndError square = mean_end_error("square", result);
    const EndError circle = mean_end_error("circle", result);
    EXPECT_LE(square.position + circle.position, kPublishedSquare.position + kPublishedCircle.position)
        << effects[0];
    EXPECT_LE(square.heading + circle.heading, kPublishedSquare.heading + kPublishedCircle.heading)
        << effects[0];
    EXPECT_LE(square.position, 1.1 * kPublishedSquare.position) << effects[0];
    EXPECT_LE(square.heading, 1.1 * kPublishedSquare.heading) << effects[0];
    EXPECT_LE(circle.position, kPublishedCircle.position) << effects[0];
    EXPECT_LE(circle.heading, kPublishedCircle.heading) << effects[0];
    EXPECT_NEAR(quantity(result.parameters, "lidar_x").value, 1e-3, 2e-4) << effects[0];
  }
}

// Defects of the plain model show where the robot turns as it drives. Half of the recordings, for their time.
TEST(Solve, optiodom_fitted_on_circles_too_does_better_on_squares) {
  ODOMCALIB_NEEDS_SHARED("optiodom");
  if (!test_support::long_tests()) GTEST_SKIP() << "takes minutes: ./test.sh --long";
  std::vector<Recording> recordings = optiodom("straight-spin", 2);
  for (Recording& circle : optiodom("circle", 2)) recordings.push_back(std::move(circle));
  const EndError plain = mean_end_error("square", solve(recordings, {{"none"}}));
  const EndError full = mean_end_error("square", solve(recordings, {{"auto"}}));
  EXPECT_LT(full.position, 0.6 * plain.position);
  EXPECT_LT(full.heading, 0.6 * plain.heading);
}

TEST(Predict, odometry_sample_by_sample_equals_the_batch) {
  ODOMCALIB_NEEDS_SHARED("maebot/empty.jsonl.gz");
  const Recording recording = load(shared_data("maebot/empty.jsonl.gz"));
  const Calibration nominal = odometry::nominal_calibration(recording.robot);
  const auto batch = odometry::predict(recording, nominal);
  odometry::Odometry odometry(nominal);
  ASSERT_EQ(batch.size(), recording.ticks.size());
  for (std::size_t k = 0; k < batch.size(); ++k) {
    const PoseSample pose = odometry.update(recording.ticks[k]);
    ASSERT_EQ(pose.x, batch[k].x);
    ASSERT_EQ(pose.y, batch[k].y);
    ASSERT_EQ(pose.yaw, batch[k].yaw);
  }
}

}  // namespace
}  // namespace odomcalib::calib::solve_test
