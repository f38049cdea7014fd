// Two-sided: a plain recording passes; each mistake of units, clocks and idle streams is told by name.
#include "calib/ingest/recording_check.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

namespace odomcalib::calib::ingest::recording_check_test {
namespace {

Recording sound() {
  Recording recording;
  recording.name = "drive.jsonl";
  recording.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  for (int k = 0; k < 500; ++k)
    recording.ticks.push_back({0.02 * k, std::int64_t{7} * k, std::int64_t{5} * k, 0});
  for (int k = 0; k < 100; ++k) {
    Scan scan;
    scan.t = 0.1 * k;
    scan.angle_min = -std::numbers::pi;
    scan.angle_increment = 2.0 * std::numbers::pi / 360.0;
    scan.range_min = 0.1;
    scan.range_max = 12.0;
    scan.ranges.assign(360, 2.0F);
    recording.scans.push_back(scan);
  }
  return recording;
}

struct Mistake {
  std::string name;
  std::function<void(Recording&)> make;
  ErrorCode code;
  std::string what, remedy;  ///< part of the text
};

template <typename Samples>
void stretch_times(Samples& samples, double factor) {
  for (auto& sample : samples) sample.t *= factor;
}

const std::vector<Mistake> kMistakes = {
    {"no_ticks", [](Recording& r) { r.ticks.clear(); }, ErrorCode::empty, "fewer than two samples of ticks",
     "motion of the wheels"},
    {"no_scans", [](Recording& r) { r.scans.clear(); }, ErrorCode::empty, "neither scans nor reference poses",
     "lidar"},
    {"one_pose",
     [](Recording& r) {
       r.poses = {{0.0, 0.0, 0.0, 0.0}};
     },
     ErrorCode::empty, "a single reference pose; it replaces 100 scans", "leave it out to use the scans"},
    {"one_pose_alone",
     [](Recording& r) {
       r.poses = {{0.0, 0.0, 0.0, 0.0}};
       r.scans.clear();
     },
     ErrorCode::empty, "neither scans nor reference poses", ""},
    {"no_unit", [](Recording& r) { r.robot.ticks_per_rev = 0.0; }, ErrorCode::missing_units, "ticks_per_rev",
     "robot line"},
    {"ticks_in_milliseconds", [](Recording& r) { stretch_times(r.ticks, 1e3); }, ErrorCode::format,
     "the times of the ticks look like milliseconds", "seconds"},
    {"scans_in_milliseconds", [](Recording& r) { stretch_times(r.scans, 1e3); }, ErrorCode::format,
     "the times of the scans look like milliseconds", "seconds"},
    {"a_sample_every_25_minutes",
     [](Recording& r) {
       stretch_times(r.ticks, 75e3);
       stretch_times(r.scans, 15e3);
     },
     ErrorCode::format, "come every 1500 s only", "at least every 2 s"},
    {"clocks_apart",
     [](Recording& r) {
       for (Scan& scan : r.scans) scan.t += 1.7e9;
     },
     ErrorCode::empty, "ticks run from 0", "same clock"},
    {"left_stands",
     [](Recording& r) {
       for (TickSample& tick : r.ticks) tick.left = 12 + tick.left % 2;
     },
     ErrorCode::empty, "the left wheel never change", "encoder"},
    {"right_stands",
     [](Recording& r) {
       for (TickSample& tick : r.ticks) tick.right = -3;
     },
     ErrorCode::empty, "the right wheel never change", "encoder"},
    {"both_stand",
     [](Recording& r) {
       for (TickSample& tick : r.ticks) tick.left = tick.right = 0;
     },
     ErrorCode::empty, "neither wheel turned", "drives"},
    {"degrees",
     [](Recording& r) {
       for (Scan& scan : r.scans) scan.angle_increment = 1.0;
     },
     ErrorCode::format, "a scan covers 359 rad", "radians"},
    {"covered",
     [](Recording& r) {
       for (Scan& scan : r.scans) scan.ranges.assign(360, 0.0F);
     },
     ErrorCode::empty, "no scan has a reading", "covers"},
    {"millimetres",
     [](Recording& r) {
       for (Scan& scan : r.scans) scan.ranges.assign(360, 0.0F);
       r.discarded.push_back({"beam", "outside range_min and range_max", 36000});
     },
     ErrorCode::format, "all 36000 readings", "metres"},
    {"millimetres_between_limits_in_metres",
     [](Recording& r) {
       for (Scan& scan : r.scans) scan.ranges.assign(360, 0.0F);
       r.discarded.push_back({"beam", "outside range_min and range_max", 100});
       r.discarded.push_back({"beam", "outside range_min and range_max: they look like millimetres", 35900});
     },
     ErrorCode::format, "m: they look like millimetres", "multiply the ranges by 0.001"},
};

class RecordingCheck : public ::testing::TestWithParam<Mistake> {};

TEST_P(RecordingCheck, tells_the_mistake_the_place_and_the_remedy) {
  Recording recording = sound();
  GetParam().make(recording);
  const auto error = check_recordings({&recording, 1});
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, GetParam().code);
  EXPECT_NE(error->what.find(GetParam().what), std::string::npos) << error->text();
  EXPECT_NE(error->remedy.find(GetParam().remedy), std::string::npos) << error->text();
  EXPECT_EQ(error->where, "drive.jsonl");
}

INSTANTIATE_TEST_SUITE_P(Mistakes, RecordingCheck, ::testing::ValuesIn(kMistakes),
                         [](const auto& mistake) { return mistake.param.name; });

TEST(RecordingCheckPasses, what_is_unusual_but_sound) {
  const Recording usual = sound();
  EXPECT_FALSE(check_recordings({&usual, 1}));
  Recording slow = sound();
  stretch_times(slow.ticks, 50.0);
  stretch_times(slow.scans, 10.0);
  EXPECT_FALSE(check_recordings({&slow, 1})) << "one sample a second";
  stretch_times(slow.ticks, 1.98);
  stretch_times(slow.scans, 1.98);
  EXPECT_FALSE(check_recordings({&slow, 1})) << "one in hardly two seconds";
  stretch_times(slow.ticks, 1.02);
  stretch_times(slow.scans, 1.02);
  EXPECT_TRUE(check_recordings({&slow, 1})) << "one in a little more";
  Recording crawling = sound();
  for (TickSample& tick : crawling.ticks) tick.left /= 1000;
  EXPECT_FALSE(check_recordings({&crawling, 1})) << "three counts";
  Recording half_blind = sound();
  for (std::size_t k = 1; k < half_blind.scans.size(); ++k) half_blind.scans[k].ranges.assign(360, 0.0F);
  EXPECT_FALSE(check_recordings({&half_blind, 1})) << "matching says how many pairs it could use";
  std::vector<Recording> about_each_wheel = {sound(), sound()};
  for (TickSample& tick : about_each_wheel[0].ticks) tick.left = 0;
  for (TickSample& tick : about_each_wheel[1].ticks) tick.right = 0;
  EXPECT_FALSE(check_recordings(about_each_wheel)) << "two recordings, a wheel stands in each";
  Recording by_poses = sound();
  by_poses.scans.clear();
  by_poses.poses = {{0.0, 0.0, 0.0, 0.0}, {1.0, 0.1, 0.0, 0.0}};
  EXPECT_FALSE(check_recordings({&by_poses, 1}));
}

}  // namespace
}  // namespace odomcalib::calib::ingest::recording_check_test
