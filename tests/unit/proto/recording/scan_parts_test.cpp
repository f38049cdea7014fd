// Messages that are parts of one scan and carry its stamp become that scan.
#include "proto/recording/scan_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace odomcalib::scan_parts_test {
namespace {

constexpr double kStep = 2.0 * std::numbers::pi / 360.0;  // rad

/// A scan of so many beams, the first of which is that of a turn with this number.
Scan part(double t, int first, std::size_t beams, double step = kStep) {
  Scan scan;
  scan.t = t;
  scan.angle_min = step * first;
  scan.angle_increment = step;
  scan.time_increment = 1e-4;
  for (std::size_t k = 0; k < beams; ++k) scan.ranges.push_back(static_cast<float>(first) + 1.0F);
  return scan;
}

/// Beam by beam, with bearings from minus to plus half a turn.
Scan listed(Scan scan) {
  for (std::size_t k = 0; k < scan.ranges.size(); ++k)
    scan.angles.push_back(static_cast<float>(std::remainder(
        scan.angle_min + scan.angle_increment * static_cast<double>(k), 2.0 * std::numbers::pi)));
  scan.angle_min = scan.angle_increment = 0.0;
  return scan;
}

TEST(PartsOfOneStamp, are_joined_to_turns_and_to_sweeps) {
  for (const double step : {kStep, -kStep})
    for (const int parts : {3, 4}) {
      std::vector<Scan> scans;
      for (const double t : {1.0, 1.1, 1.2})
        for (int k = 0; k < parts; ++k) scans.push_back(part(t, 90 * k, 90, step));
      EXPECT_EQ(join_parts_of_one_stamp(scans), 3U * (static_cast<unsigned>(parts) - 1U));
      ASSERT_EQ(scans.size(), 3U);
      EXPECT_EQ(scans[1].ranges.size(), 90U * static_cast<unsigned>(parts));
      EXPECT_EQ(scans[1].ranges[185], 181.0F);
      EXPECT_EQ(scans[1].angle_min, 0.0);
      EXPECT_EQ(scans[1].t, 1.1);
    }
}

TEST(PartsOfOneStamp, may_state_the_bearing_of_each_beam) {
  std::vector<Scan> scans = {listed(part(1.0, 100, 90)), listed(part(1.0, 190, 90)),
                             listed(part(1.1, 100, 90))};
  EXPECT_EQ(join_parts_of_one_stamp(scans), 1U);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].angles.size(), 180U);
}

TEST(PartsOfOneStamp, are_no_repeated_scans_and_of_one_lidar) {
  const Scan turn = part(1.0, 0, 360), half = part(1.0, 0, 180), next = part(1.0, 180, 180);
  Scan other = next, later = next, apart = part(1.0, 182, 90), timed = next;
  other.sensor = "rear";
  later.t = 1.01;
  timed.times.assign(180, 0.0F);
  for (const Scan& second : {turn, half, other, later, apart, listed(next), timed}) {
    std::vector<Scan> scans = {second.ranges.size() == 360 ? turn : half, second};
    EXPECT_EQ(join_parts_of_one_stamp(scans), 0U);
    EXPECT_EQ(scans.size(), 2U);
  }
}

}  // namespace
}  // namespace odomcalib::scan_parts_test
