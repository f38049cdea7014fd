// A clock that is set back is told from samples that come late, and only where another device's clock goes
// on.
#include "proto/recording/clock_set_back.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "proto/recording/recording.hpp"

namespace odomcalib::clock_set_back_test {
namespace {

constexpr double kPeriod = 0.02;        // s
constexpr std::size_t kSamples = 2000;  // 40 s
constexpr std::size_t kStep = 900;      // sample, the first after the step

/// With the jitter of a driver.
std::vector<double> even_stamps() {
  std::mt19937 engine(4);
  std::normal_distribution<double> jitter(0.0, 0.1 * kPeriod);
  std::vector<double> stamps;
  for (std::size_t k = 0; k < kSamples; ++k)
    stamps.push_back(100.0 + kPeriod * static_cast<double>(k) + jitter(engine));
  return stamps;
}

std::vector<double> with_step(double back) {
  std::vector<double> stamps = even_stamps();
  for (std::size_t k = kStep; k < stamps.size(); ++k) stamps[k] -= back;
  return stamps;
}

TEST(ClockSetBack, is_found_with_its_moment_and_its_size) {
  for (const double back : {0.08, 0.3, 3.0, 60.0, 3600.0}) {
    const auto steps = set_back(with_step(back));
    ASSERT_EQ(steps.size(), 1U) << back;
    EXPECT_EQ(steps.front().first, kStep);
    EXPECT_NEAR(steps.front().by, back, 0.5 * kPeriod);
  }
}

TEST(ClockSetBack, is_undone_to_the_jitter_of_the_stamps) {
  const auto stamps = with_step(3.0);
  const auto whole = without_steps(stamps, set_back(stamps)), even = even_stamps();
  for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_NEAR(whole[k], even[k], 0.5 * kPeriod);
}

TEST(ClockSetBack, is_found_although_samples_get_lost) {
  auto stamps = with_step(1.0);
  std::size_t k = 0;
  std::erase_if(stamps, [&](double) { return k++ % 10 == 3; });
  EXPECT_EQ(set_back(stamps).size(), 1U);
}

TEST(ClockSetBack, is_no_block_of_samples_that_comes_late) {
  for (const std::ptrdiff_t late : {1, 2, 3, 5, 40})
    for (const std::ptrdiff_t before : {1, 2, 3, 5, 40}) {
      auto stamps = even_stamps();
      const auto begin = stamps.begin() + 500;
      std::rotate(begin, begin + late, begin + late + before);
      EXPECT_TRUE(set_back(stamps).empty()) << late << " after " << before;
    }
}

TEST(ClockSetBack, is_no_single_stamp_and_no_second_clock_in_between) {
  auto stamps = even_stamps();
  stamps[700] += 500.0;
  stamps[1200] -= 50.0;
  EXPECT_TRUE(set_back(stamps).empty());
  for (std::size_t k = 0; k < stamps.size(); k += 2) stamps[k] -= 0.4;
  EXPECT_TRUE(set_back(stamps).empty());
}

// --- Of a recording --------------------------------------------------------------------------------------

constexpr const char* kRobotLine =
    R"({"type":"robot","wheel_diameter":0.1,"track_width":0.3,"ticks_per_rev":1000})"
    "\n";

/// Counts every 0.02 s beside poses every 0.1 s, each stamp as told, in the order in which they come.
template <typename OfCounts, typename OfPoses>
Recording recorded(OfCounts of_counts, OfPoses of_poses) {
  std::string text = kRobotLine;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.02 * k;
    const std::string count = std::to_string(20 * k);
    text += R"({"type":"ticks","t":)" + std::to_string(of_counts(t)) + R"(,"left":)" + count +
            R"(,"right":)" + count + "}\n";
    if (k % 5 == 0)
      text += R"({"type":"pose","t":)" + std::to_string(of_poses(t)) + R"(,"x":)" + std::to_string(t) +
              R"(,"y":0,"yaw":0})"
              "\n";
  }
  return read_recording_bytes(text, "drive.jsonl").value();
}

double as_it_is(double t) { return t; }
double set_back_by_3(double t) { return t < 20.0 ? t : t - 3.0; }

TEST(ClockSetBack, puts_one_stream_on_the_clock_it_had) {
  const Recording recording = recorded(set_back_by_3, as_it_is);
  ASSERT_EQ(recording.ticks.size(), 2000U);
  for (std::size_t k = 0; k < 2000; ++k)
    EXPECT_NEAR(recording.ticks[k].t, 0.02 * static_cast<double>(k), 1e-4);
  EXPECT_TRUE(recording.discarded.empty());
  ASSERT_EQ(recording.repairs.size(), 1U);
  EXPECT_EQ(
      recording.repairs.front().reason,
      "stamps of the counts step by -3.00 s at 20 s against those of the poses: their clock was set back");
}

TEST(ClockSetBack, names_the_stream_whose_clock_it_was) {
  const Recording recording = recorded(as_it_is, set_back_by_3);
  ASSERT_EQ(recording.repairs.size(), 1U);
  EXPECT_THAT(recording.repairs.front().reason, ::testing::StartsWith("stamps of the poses step by -3.00 s"));
}

TEST(ClockSetBack, is_not_told_where_files_were_joined_in_the_wrong_order) {
  const Recording recording = recorded(set_back_by_3, set_back_by_3);
  EXPECT_TRUE(recording.repairs.empty());
  EXPECT_FALSE(recording.discarded.empty()) << "out of order, as ever";
}

TEST(ClockSetBack, is_not_told_of_a_sound_recording) {
  const Recording recording = recorded(as_it_is, as_it_is);
  EXPECT_TRUE(recording.repairs.empty());
  EXPECT_TRUE(recording.discarded.empty());
}

}  // namespace
}  // namespace odomcalib::clock_set_back_test
