#include "calib/ingest/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::calib::ingest::frames_test {
namespace {

/// Odometry along arcs to either side, 40 m, that begins anew at the origin once.
Recording begun_anew(bool exactly) {
  Recording recording;
  recording.motion = MotionSource::odometry;
  recording.robot.track_width = 0.4;
  PoseSample pose;
  for (int k = 0; k < 2000; ++k) {
    const double turn = (k / 200) % 2 == 0 ? 0.01 : -0.01;
    pose.t = 0.02 * k;
    pose.x += 0.02 * std::cos(pose.yaw + 0.5 * turn);
    pose.y += 0.02 * std::sin(pose.yaw + 0.5 * turn);
    pose.yaw += turn;
    if (k == 1201) pose = {pose.t, exactly ? 0.0 : 1e-3, 0.0, 0.0};
    recording.odometry.push_back(pose);
  }
  return recording;
}

TEST(OdometryFrame, goes_sideways_over_no_reset) {
  EXPECT_FALSE(wrong_odometry_frame(begun_anew(true)));
  const auto jump = wrong_odometry_frame(begun_anew(false));
  ASSERT_TRUE(jump);
  EXPECT_NE(jump->what.find("goes sideways"), std::string::npos) << jump->what;
}

}  // namespace
}  // namespace odomcalib::calib::ingest::frames_test
