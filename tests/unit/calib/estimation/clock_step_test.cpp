// Clocks that are set while recording, of either stream and in either direction.
#include "calib/estimation/clock_step.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "calib/estimation/clock_leap.hpp"
#include "calib/ingest/even_stamps.hpp"
#include "calib/solve.hpp"
#include "tests/unit/calib/driven_recording.hpp"

namespace odomcalib::calib::estimation::clock_step_test {
namespace {

constexpr double kMoment = 60.0;  // s, the middle of the drive

enum class Whose { counts, reference };

/// Sorted, as readers sort.
template <typename Sample>
void step(std::vector<Sample>& samples, double size) {
  for (Sample& sample : samples)
    if (sample.t > kMoment) sample.t += size;
  const auto earlier = [](const Sample& a, const Sample& b) { return a.t < b.t; };
  std::stable_sort(samples.begin(), samples.end(), earlier);
  const auto same = [](const Sample& a, const Sample& b) { return a.t == b.t; };
  samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
}

Recording drive_with_step(Whose whose, double size) {
  Recording recording = test_support::driven_recording({});
  if (whose == Whose::counts)
    step(recording.ticks, size);
  else
    step(recording.poses, size);
  return recording;
}

measurement::Dataset put_right(const Recording& recording) {
  auto opened = measurement::open_dataset(ingest::Recordings({&recording, 1}));
  EXPECT_TRUE(opened);
  return without_clock_steps(measured_roughly(without_clock_leaps(std::move(opened).value())));
}

bool stamps_advance(const std::vector<double>& stamps) {
  return std::adjacent_find(stamps.begin(), stamps.end(), std::greater_equal<>()) == stamps.end();
}

std::string said_of(const Recording& recording) {
  std::string text;
  for (const Repair& repair : recording.repairs) text += repair.reason;
  return text;
}

class ClockStep : public ::testing::TestWithParam<std::tuple<Whose, double>> {};

TEST_P(ClockStep, leaves_stamps_that_advance_and_says_by_how_much_they_stepped) {
  const auto [whose, size] = GetParam();
  const Recording recording = drive_with_step(whose, size);
  const measurement::Dataset dataset = put_right(recording);
  const Recording& mended = dataset.recordings.front();
  EXPECT_TRUE(stamps_advance(stamps_of(mended.poses)));
  EXPECT_TRUE(stamps_advance(stamps_of(mended.ticks)));
  const std::string said = said_of(mended);
  const bool of_counts = said.find("of the counts step") != std::string::npos;
  const bool ahead = (of_counts == (whose == Whose::counts)) == (size > 0.0);
  EXPECT_THAT(said, ::testing::ContainsRegex(std::string("step by ") + (ahead ? "" : "-") +
                                             "(0\\.(39|4[01])|1\\.(4[789]|5[012])) s"));
}

void expect_right_lengths(const Recording& recording) {
  const Calibration calibration = solve({&recording, 1}, {});
  EXPECT_NE(calibration.verdict, Verdict::refused);
  const auto expect_near = [&](const char* name, double value) {
    EXPECT_NEAR(calibration.parameter(name).value_or(0.0), value, 1e-3 * value) << name;
  };
  expect_near("left_wheel_diameter", 2.0 * test_support::kLeftRadius);
  expect_near("right_wheel_diameter", 2.0 * test_support::kRightRadius);
  expect_near("track_width", test_support::kTrackWidth);
}

TEST_P(ClockStep, does_no_harm_to_the_lengths) {
  const auto [whose, size] = GetParam();
  expect_right_lengths(drive_with_step(whose, size));
}

INSTANTIATE_TEST_SUITE_P(Clocks, ClockStep,
                         ::testing::Combine(::testing::Values(Whose::counts, Whose::reference),
                                            ::testing::Values(-1.5, -0.4, 0.4, 1.5)));

TEST(OneClockStep, is_not_told_of_a_sound_drive) {
  const Recording recording = test_support::driven_recording({});
  EXPECT_EQ(said_of(put_right(recording).recordings.front()), "");
}

// Steps ahead that leave a gap beyond the reach of the search.
class ClockLeap : public ::testing::TestWithParam<std::tuple<Whose, double>> {};

TEST_P(ClockLeap, is_told_with_its_size_and_does_no_harm_to_the_lengths) {
  const auto [whose, size] = GetParam();
  const Recording recording = drive_with_step(whose, size);
  const std::string said = said_of(put_right(recording).recordings.front());
  EXPECT_THAT(
      said, ::testing::HasSubstr("stamps of the " + std::string(whose == Whose::counts ? "counts" : "poses") +
                                 " step by " + std::to_string(static_cast<int>(size)) + "."));
  EXPECT_THAT(said, ::testing::HasSubstr("s at 60 s"));
  expect_right_lengths(recording);
}

INSTANTIATE_TEST_SUITE_P(Clocks, ClockLeap,
                         ::testing::Combine(::testing::Values(Whose::counts, Whose::reference),
                                            ::testing::Values(3.0, 10.0, 60.0, 3600.0)));

TEST(OneClockLeap, is_not_told_of_a_device_that_falls_silent) {
  for (const Whose whose : {Whose::counts, Whose::reference}) {
    Recording recording = test_support::driven_recording({});
    const auto silent = [](const auto& sample) { return sample.t > 50.0 && sample.t < 65.0; };
    if (whose == Whose::counts)
      std::erase_if(recording.ticks, silent);
    else
      std::erase_if(recording.poses, silent);
    EXPECT_EQ(said_of(put_right(recording).recordings.front()), "");
    expect_right_lengths(recording);
  }
}

TEST(OneClockLeap, is_not_told_of_a_recording_that_was_paused) {
  Recording recording = test_support::driven_recording({});
  step(recording.ticks, 30.0);
  step(recording.poses, 30.0);
  EXPECT_EQ(said_of(put_right(recording).recordings.front()), "");
}

// The search ends nearer than that: what it finds at its end is no measurement.
TEST(OneClockStep, is_not_told_as_large_as_the_search_reaches) {
  for (const double size : {-3.5, -2.6}) {
    const Recording recording = drive_with_step(Whose::counts, size);
    EXPECT_THAT(said_of(put_right(recording).recordings.front()),
                ::testing::Not(::testing::ContainsRegex("step by -?(1\\.9|2\\.)")));
  }
}

}  // namespace
}  // namespace odomcalib::calib::estimation::clock_step_test
