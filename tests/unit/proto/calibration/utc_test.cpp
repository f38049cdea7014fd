#include "proto/calibration/utc.hpp"

#include <gtest/gtest.h>

namespace odomcalib::utc_test {
namespace {

constexpr double kSomeDay_s = 1764411585.0;  // 2025-11-29 10:19:45

TEST(Utc, is_written_to_the_second_and_read_back) {
  EXPECT_EQ(utc_text(kSomeDay_s + 0.9), "2025-11-29T10:19:45Z");
  EXPECT_EQ(utc_from("2025-11-29T10:19:45Z"), kSomeDay_s);
  EXPECT_FALSE(utc_from("yesterday").has_value());
}

TEST(Utc, for_people_names_both_days_only_where_there_are_two) {
  EXPECT_EQ(utc_span(kSomeDay_s, kSomeDay_s + 3900.0), "2025-11-29, 10:19 to 11:24 UTC");
  EXPECT_EQ(utc_span(kSomeDay_s, kSomeDay_s + 86400.0), "2025-11-29, 10:19 to 2025-11-30, 10:19 UTC");
}

TEST(Utc, tells_a_date_from_a_clock_that_counts_from_elsewhere) {
  EXPECT_TRUE(is_date(kSomeDay_s));
  EXPECT_FALSE(is_date(12.0));
  EXPECT_FALSE(is_date(1e3 * kSomeDay_s)) << "ms";
}

}  // namespace
}  // namespace odomcalib::utc_test
