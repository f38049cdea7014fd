#include "calib/classical/motion_kinds.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::calib::classical::motion_kinds_test {
namespace {

constexpr double kRadius = 0.075, kTrack = 0.4, kStep_s = 0.02;

/// A drive of pieces, sampled fifty times a second.
class Drive {
 public:
  Drive() { sample(0.0, 0.0); }
  /// @param forward m/s
  /// @param turn rad/s
  Drive& go(double forward, double turn, double duration) {
    for (int k = 0; k < std::lround(duration / kStep_s); ++k)
      sample((forward - 0.5 * kTrack * turn) * kStep_s / kRadius,
             (forward + 0.5 * kTrack * turn) * kStep_s / kRadius);
    return *this;
  }
  Drive& lose_counts() {
    ++segment_;
    return *this;
  }
  [[nodiscard]] MotionKinds kinds() const { return motion_kinds(track_, {kRadius, kRadius, kTrack, {}}); }

 private:
  void sample(double left, double right) {
    track_.t.push_back(kStep_s * static_cast<double>(track_.t.size()));
    track_.left.push_back((track_.left.empty() ? 0.0 : track_.left.back()) + left);
    track_.right.push_back((track_.right.empty() ? 0.0 : track_.right.back()) + right);
    track_.segment.push_back(segment_);
  }
  wheels::WheelTrack track_;
  int segment_ = 0;
};

const ParameterSupply& of(const std::vector<ParameterSupply>& all, const std::string& parameter) {
  for (const ParameterSupply& one : all)
    if (one.parameters.find(parameter) != std::string::npos) return one;
  ADD_FAILURE() << parameter << " is missing";
  return all.front();
}

TEST(MotionKinds, counts_each_kind_by_itself) {
  const MotionKinds kinds = Drive()
                                .go(0.3, 0.0, 10.0)
                                .go(-0.3, 0.0, 5.0)
                                .go(0.0, 0.5, 8.0)
                                .go(0.0, -0.5, 4.0)
                                .go(0.3, 0.5, 4.0)
                                .kinds();
  EXPECT_NEAR(kinds.forward.amount, 3.0, 0.16);
  EXPECT_NEAR(kinds.backward.amount, 1.5, 0.16);
  EXPECT_NEAR(kinds.spin_left.amount, 4.0, 0.26);
  EXPECT_NEAR(kinds.spin_right.amount, 2.0, 0.26);
  EXPECT_NEAR(kinds.arc_left.amount, 2.0, 0.26);
  EXPECT_EQ(kinds.arc_right.stretches, 0U);
  EXPECT_NEAR(kinds.way_forward, 4.2, 0.3) << "in the bend, too";
  EXPECT_NEAR(kinds.way_backward, 1.5, 0.16);
  EXPECT_EQ(kinds.stops, 0U);
}

TEST(MotionKinds, counts_stops_that_last_and_nothing_across_lost_counts) {
  const MotionKinds kinds = Drive()
                                .go(0.0, 0.0, 1.0)
                                .go(0.3, 0.0, 1.0)
                                .go(0.0, 0.0, 0.3)
                                .go(0.3, 0.0, 1.0)
                                .go(0.0, 0.0, 0.7)
                                .kinds();
  EXPECT_EQ(kinds.stops, 2U);
  const MotionKinds lost = Drive().lose_counts().go(300.0, 0.0, kStep_s).kinds();
  EXPECT_EQ(lost.forward.stretches, 0U);
}

TEST(ParameterSupply, of_a_full_drive_is_enough) {
  for (const ParameterSupply& one : parameter_supply(
           Drive().go(0.3, 0.0, 4.5).go(-0.3, 0.0, 4.5).go(0.0, 0.6, 12.0).go(0.0, -0.6, 12.0).kinds()))
    EXPECT_EQ(one.supply, Supply::enough) << one.parameters;
}

TEST(ParameterSupply, says_which_parameter_lacks_which_motion) {
  const auto straight = parameter_supply(Drive().go(0.3, 0.0, 4.5).go(-0.3, 0.0, 4.5).kinds());
  EXPECT_EQ(of(straight, "left_wheel_diameter").supply, Supply::enough);
  EXPECT_EQ(of(straight, "lidar_yaw").supply, Supply::enough);
  EXPECT_EQ(of(straight, "track_width").supply, Supply::missing);
  EXPECT_EQ(of(straight, "lidar_x").supply, Supply::missing);
  const auto one_way = parameter_supply(Drive().go(0.3, 0.0, 20.0).go(0.0, 0.6, 30.0).kinds());
  for (const ParameterSupply& one : one_way)
    EXPECT_EQ(one.supply, Supply::little) << one.parameters << ": one way alone";
  const auto half = parameter_supply(
      Drive().go(0.3, 0.0, 4.5).go(-0.3, 0.0, 4.5).go(0.0, 0.6, 6.0).go(0.0, -0.6, 6.0).kinds());
  EXPECT_EQ(of(half, "track_width").supply, Supply::little);
  EXPECT_EQ(of(half, "lidar_x").supply, Supply::enough);
}

}  // namespace
}  // namespace odomcalib::calib::classical::motion_kinds_test
