#include "calib/classical/motion_kinds.hpp"

#include <gtest/gtest.h>

namespace odomcalib::calib::classical::missing_motion_test {
namespace {

using Motions = std::vector<wheels::WheelMotion>;

TEST(MissingMotion, is_what_was_not_driven) {
  const auto of = [](const Motions& motions) { return missing_motion(motions).value_or("none"); };
  EXPECT_EQ(of({{1.0, 1.0, {}}, {-1.0, -1.01, {}}}), "turns on the spot, both ways");
  EXPECT_EQ(of({{1.0, -1.0, {}}, {-1.0, 1.02, {}}}), "straight lines, forward and backward");
  EXPECT_EQ(of({{1.0, 2.0, {}}, {1.1, 2.2, {}}, {-0.5, -1.0, {}}}),
            "straight lines and turns on the spot in one drive")
      << "one circle, with whatever speed";
  EXPECT_EQ(of({}), "straight lines, arcs and turns on the spot, both ways");
}

TEST(MissingMotion, is_none_where_lines_and_turns_or_two_arcs_were_driven) {
  EXPECT_FALSE(missing_motion(Motions{{1.0, 1.0, {}}, {1.0, -1.0, {}}}));
  EXPECT_FALSE(missing_motion(Motions{{1.0, 2.0, {}}, {2.0, 1.0, {}}}));
}

}  // namespace
}  // namespace odomcalib::calib::classical::missing_motion_test
