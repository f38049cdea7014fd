// Readings that stand for no return, and poses that look elsewhere than they go; two-sided. Units of streams
// are tested with recording_check.
#include "calib/ingest/unit_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "calib/ingest/frames.hpp"
#include "calib/ingest/phantom_return.hpp"

namespace odomcalib::calib::ingest::unit_check_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr unsigned kSeed = 3;

/// A lidar that drives through a room of 8 m by 6 m, ranges in whole steps.
Recording through_a_room(double step) {
  Recording recording;
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> noise(0.0, 0.004);
  for (int k = 0; k < 400; ++k) {
    Scan scan;
    scan.t = 0.1 * k;
    scan.angle_increment = 2.0 * kPi / 360.0;
    scan.range_max = 12.0;
    const double x = 2.0 * std::sin(0.02 * k), y = 1.5 * std::cos(0.013 * k);
    for (int beam = 0; beam < 360; ++beam) {
      const double c = std::cos(scan.angle(static_cast<std::size_t>(beam))),
                   s = std::sin(scan.angle(static_cast<std::size_t>(beam)));
      const double range = std::min(((c > 0.0 ? 4.0 : -4.0) - x) / c, ((s > 0.0 ? 3.0 : -3.0) - y) / s);
      scan.ranges.push_back(static_cast<float>(step * std::round((range + noise(engine)) / step)));
    }
    recording.scans.push_back(scan);
  }
  return recording;
}

TEST(PhantomReturn, is_not_seen_in_the_ranges_of_walls) {
  for (const double step : {0.001, 0.01, 0.05})
    EXPECT_FALSE(phantom_return(through_a_room(step))) << "steps of " << step << " m, seed " << kSeed;
}

TEST(PhantomReturn, is_found_where_a_twentieth_of_the_beams_return_nothing) {
  Recording recording = through_a_room(0.001);
  for (std::size_t k = 0; k < recording.scans.size(); ++k)
    for (std::size_t beam = 0; beam < 18; ++beam) recording.scans[k].ranges[(beam + 7 * k) % 360] = 4.6F;
  const auto found = phantom_return(recording);
  ASSERT_TRUE(found);
  EXPECT_FLOAT_EQ(static_cast<float>(*found), 4.6F);
  const Cleaned without = without_phantom_returns({&recording, 1});
  const Recording& cleaned = without.recordings.front();
  EXPECT_FALSE(phantom_return(cleaned));
  ASSERT_EQ(cleaned.discarded.size(), 1U);
  EXPECT_GE(cleaned.discarded[0].count, 400U * 18U);
  ASSERT_EQ(without.remarks.size(), 1U);
  EXPECT_NE(without.remarks[0].find("exactly 4.6 m wherever"), std::string::npos) << without.remarks[0];
  const Cleaned again = without_phantom_returns(without.recordings.view());
  EXPECT_TRUE(again.recordings.are_those_of(without.recordings)) << "nothing is left to take out";
  EXPECT_TRUE(again.remarks.empty());
}

TEST(PhantomReturn, is_not_asked_near_the_range_where_the_lidar_gives_up) {
  Recording recording = through_a_room(0.001);
  for (Scan& scan : recording.scans)
    for (std::size_t beam = 0; beam < 40; ++beam) scan.ranges[beam] = 12.0F;
  EXPECT_FALSE(phantom_return(recording));
}

/// Ahead and back along a way that bends, heading along it.
Recording along_its_heading(double sideways = 0.0) {
  Recording recording;
  PoseSample pose;
  for (int k = 0; k < 600; ++k) {
    const double step = k % 200 < 150 ? 0.02 : -0.02;
    pose.t = 0.05 * k;
    pose.yaw += 0.8 * 0.02;
    pose.x += step * std::cos(pose.yaw + sideways);
    pose.y += step * std::sin(pose.yaw + sideways) + (k > 300 ? 0.004 * std::sin(pose.yaw) : 0.0);
    recording.poses.push_back(pose);
  }
  return recording;
}

TEST(PoseFrame, is_not_contradicted_by_poses_that_go_where_they_look) {
  EXPECT_FALSE(wrong_pose_frame(along_its_heading()));
  EXPECT_FALSE(wrong_pose_frame(along_its_heading(0.2))) << "a marker that looks a little aside";
  EXPECT_FALSE(wrong_pose_frame(along_its_heading(kPi))) << "which end is front only the wheels know";
  EXPECT_FALSE(wrong_pose_frame(Recording{}));
}

/// Lines of a metre that turn by 10 degrees and back.
Recording nearly_straight(double sign, double aside) {
  Recording recording;
  PoseSample pose;
  for (int k = 0; k < 600; ++k) {
    const double heading = k / 100 % 2 == 0 ? 0.0 : 10.0 * kPi / 180.0;
    pose.t = 0.05 * k;
    pose.x += 0.02 * std::cos(heading);
    pose.y += 0.02 * std::sin(heading) + 0.001 * std::sin(3.0 * k);
    pose.yaw = sign * (heading + aside);
    recording.poses.push_back(pose);
  }
  return recording;
}

TEST(PoseFrame, sees_yaw_of_the_other_sign_in_turns_of_ten_degrees) {
  for (const double aside : {0.0, 0.1, -0.3}) {
    EXPECT_FALSE(wrong_pose_frame(nearly_straight(1.0, aside))) << aside;
    const auto error = wrong_pose_frame(nearly_straight(-1.0, aside));
    ASSERT_TRUE(error) << aside;
    EXPECT_NE(error->what.find("turns clockwise"), std::string::npos) << error->what;
  }
}

TEST(PoseFrame, names_what_is_wrong_with_yaw) {
  const auto told = [](double (*change)(double)) {
    Recording recording = along_its_heading();
    for (PoseSample& pose : recording.poses) pose.yaw = change(pose.yaw);
    const auto error = wrong_pose_frame(recording);
    return error ? error->what : "";
  };
  const auto holds = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(holds(told([](double yaw) { return yaw * 180.0 / kPi; }), "degrees"));
  EXPECT_TRUE(holds(told([](double yaw) { return -yaw; }), "opposite sign"));
  EXPECT_TRUE(holds(told([](double yaw) { return 0.3 - yaw; }), "turns clockwise")) << "and looks aside";
  EXPECT_TRUE(holds(told([](double yaw) { return 0.5 * kPi - yaw; }), "compass"));
  EXPECT_TRUE(holds(told([](double yaw) { return 0.5 * yaw; }), "half of the heading"));
  EXPECT_TRUE(holds(told([](double yaw) { return yaw - 0.5 * kPi; }), "quarter"));
  EXPECT_TRUE(holds(told([](double) { return 0.3; }), "never changes"));
}

TEST(UnitOfInterval, names_the_one_unit_that_fits) {
  EXPECT_EQ(unit_of_interval(0.02), "");
  EXPECT_EQ(unit_of_interval(1.0), "");
  EXPECT_EQ(unit_of_interval(20.0), "milliseconds");
  EXPECT_EQ(unit_of_interval(2e4), "microseconds");
  EXPECT_EQ(unit_of_interval(1e8), "nanoseconds");
  EXPECT_EQ(unit_of_interval(0.1 / 60.0), "minutes");
}

}  // namespace
}  // namespace odomcalib::calib::ingest::unit_check_test
