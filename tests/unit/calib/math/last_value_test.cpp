#include "calib/math/last_value.hpp"

#include <gtest/gtest.h>

namespace odomcalib::calib::math::last_value_test {
namespace {

TEST(LastValue, computes_once_what_is_asked_for_twice_in_a_row) {
  int computed = 0;
  LastValue square([&](double x) {
    ++computed;
    return x * x;
  });
  EXPECT_EQ(square(0.0), 0.0);
  EXPECT_EQ(computed, 1) << "nothing is known before the first call, of zero neither";
  EXPECT_EQ(square(3.0), 9.0);
  EXPECT_EQ(square(3.0), 9.0);
  EXPECT_EQ(computed, 2);
  EXPECT_EQ(square(0.0), 0.0);
  EXPECT_EQ(computed, 3) << "only the last value is kept";
}

}  // namespace
}  // namespace odomcalib::calib::math::last_value_test
