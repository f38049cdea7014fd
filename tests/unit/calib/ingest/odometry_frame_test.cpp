// Where a frame of odometry sits beside the axle, by what it does while the robot turns on the spot.
#include "calib/ingest/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace odomcalib::calib::ingest::odometry_frame_test {
namespace {

constexpr double kTrack = 0.4;  // m

struct Move {
  double speed = 0.0, turn = 0.0;  ///< m/s, rad/s
};

/// Odometry of a frame (ahead, left) of the middle of the axle, at 50 Hz, each move for 6 s, rounded to a
/// tenth of a millimetre as text is.
Recording odometry_of(const std::vector<Move>& moves, double ahead, double left) {
  Recording recording;
  recording.motion = MotionSource::odometry;
  recording.robot.track_width = kTrack;
  double x = 0.0, y = 0.0, yaw = 0.3, t = 0.0;
  const auto rounded = [](double value) { return 1e-4 * std::round(1e4 * value); };
  for (const Move& move : moves)
    for (int k = 0; k < 300; ++k, t += 0.02) {
      recording.odometry.push_back({t, rounded(x + ahead * std::cos(yaw) - left * std::sin(yaw)),
                                    rounded(y + ahead * std::sin(yaw) + left * std::cos(yaw)), yaw});
      const double middle = yaw + 0.01 * move.turn;
      x += 0.02 * move.speed * std::cos(middle);
      y += 0.02 * move.speed * std::sin(middle);
      yaw += 0.02 * move.turn;
    }
  return recording;
}

const std::vector<Move> kDrive = {{0.2, 0.0},  {0.0, 0.6},  {-0.2, 0.0}, {0.0, -0.6}, {0.2, 0.4},
                                  {0.2, -0.4}, {-0.2, 0.3}, {0.0, 0.5},  {0.0, -0.5}, {0.2, 0.1}};

TEST(BesideAxle, is_the_distance_to_the_left_of_the_axle) {
  for (const double left : {-0.2, -0.1, 0.05, 0.1, 0.2}) {
    const auto found = beside_axle(odometry_of(kDrive, 0.0, left));
    ASSERT_TRUE(found) << left;
    EXPECT_NEAR(*found, left, 0.002);
  }
}

TEST(BesideAxle, is_nothing_of_a_frame_on_the_axle_or_ahead_of_it) {
  EXPECT_FALSE(beside_axle(odometry_of(kDrive, 0.0, 0.0)));
  EXPECT_FALSE(beside_axle(odometry_of(kDrive, 0.3, 0.0)));
  EXPECT_FALSE(beside_axle(odometry_of(kDrive, 0.0, 0.005))) << "less than a weak motor shifts it by";
}

TEST(BesideAxle, is_nothing_where_only_arcs_are_driven) {
  const std::vector<Move> arcs = {{0.05, 0.5}, {0.05, -0.5}, {0.08, 0.5}, {0.08, -0.5}, {0.2, 0.0}};
  EXPECT_FALSE(beside_axle(odometry_of(arcs, 0.0, 0.0))) << "to the left about a point on the left";
}

TEST(BesideAxle, is_nothing_without_turns_both_ways) {
  EXPECT_FALSE(beside_axle(odometry_of({{0.2, 0.0}, {0.0, 0.6}, {0.0, 0.6}}, 0.0, 0.1)));
}

TEST(RoundedOdometry, is_blamed_for_its_digits_and_not_for_its_yaw) {
  const auto rounded = [](double unit) {
    Recording recording = odometry_of(kDrive, 0.0, 0.0);
    for (PoseSample& p : recording.odometry)
      p.x = unit * std::round(p.x / unit), p.y = unit * std::round(p.y / unit);
    return recording;
  };
  const auto error = wrong_odometry_frame(rounded(0.01));
  ASSERT_TRUE(error);
  EXPECT_NE(error->what.find("rounded to 10 mm"), std::string::npos) << error->what;
  EXPECT_NE(error->remedy.find("four digits"), std::string::npos) << error->remedy;
  EXPECT_NE(wrong_odometry_frame(rounded(0.005))->what.find("rounded to 5 mm"), std::string::npos);
  EXPECT_FALSE(wrong_odometry_frame(rounded(0.001)));
  // Yaw of another sensor, beside numbers with digits enough.
  Recording other = odometry_of(kDrive, 0.0, 0.0);
  for (PoseSample& p : other.odometry) p.yaw += 0.3 * std::sin(p.t);
  EXPECT_NE(wrong_odometry_frame(other)->what.find("do not belong together"), std::string::npos);
}

TEST(BesideAxle, is_nothing_of_counts) {
  Recording recording = odometry_of(kDrive, 0.0, 0.1);
  recording.motion = MotionSource::wheels;
  EXPECT_FALSE(beside_axle(recording));
}

}  // namespace
}  // namespace odomcalib::calib::ingest::odometry_frame_test
