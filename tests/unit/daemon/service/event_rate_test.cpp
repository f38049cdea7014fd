#include "daemon/service/event_rate.hpp"

#include <gtest/gtest.h>

#include "daemon/service/settings.hpp"

namespace odomcalib::event_rate_test {
namespace {

using service::settings::kEventPause_s;
constexpr int kAtOnce = static_cast<int>(service::settings::kEventsAtOnce);

TEST(EventRate, lets_some_through_at_once_and_one_after_each_pause) {
  EventRate rate;
  for (int i = 0; i < kAtOnce; ++i) EXPECT_EQ(rate.admit("bus", 10.0), 0U) << i;
  for (int i = 0; i < 7; ++i) EXPECT_EQ(rate.admit("bus", 10.0 + 0.1 * i), std::nullopt) << i;
  EXPECT_EQ(rate.admit("bus", 10.1 + kEventPause_s), 7U) << "how many were left out";
  EXPECT_EQ(rate.admit("bus", 10.2 + kEventPause_s), std::nullopt);
  EXPECT_EQ(rate.admit("bus", 10.2 + 2.0 * kEventPause_s), 1U);
}

TEST(EventRate, counts_each_kind_by_itself) {
  EventRate rate;
  for (int i = 0; i < 3 * kAtOnce; ++i) (void)rate.admit("bus", 0.0);
  EXPECT_EQ(rate.admit("stopped", 0.0), 0U);
}

TEST(EventRate, after_quiet_hours_is_no_more_than_at_the_start) {
  EventRate rate;
  (void)rate.admit("bus", 0.0);
  int passed = 0;
  for (int i = 0; i < 5 * kAtOnce; ++i) passed += rate.admit("bus", 36000.0) ? 1 : 0;
  EXPECT_EQ(passed, kAtOnce);
}

}  // namespace
}  // namespace odomcalib::event_rate_test
