#include "daemon/service/loop_guard.hpp"

#include <gtest/gtest.h>

#include <array>

#include "daemon/service/settings.hpp"

namespace odomcalib::loop_guard_test {
namespace {

constexpr std::array kNames = {"base", "lidar", "client"};
constexpr std::size_t kMost = service::settings::kMostIdleTurns;

TEST(LoopGuard, names_calls_that_wait_and_are_never_served) {
  LoopGuard guard(kNames);
  for (std::size_t i = 0; i + 1 < kMost; ++i) guard.turned(true, false);
  EXPECT_EQ(guard.hangs_at(), "");
  guard.turned(true, false);
  EXPECT_NE(guard.hangs_at().find("client"), std::string::npos) << guard.hangs_at();
}

TEST(LoopGuard, finds_nothing_in_a_flood_that_is_served_or_in_turns_that_wait) {
  LoopGuard guard(kNames);
  for (std::size_t i = 0; i < 3 * kMost; ++i) guard.turned(true, i % (kMost - 1) == 0);
  for (std::size_t i = 0; i < 3 * kMost; ++i) guard.turned(false, false);
  EXPECT_EQ(guard.hangs_at(), "");
}

TEST(LoopGuard, names_a_descriptor_that_is_not_open) {
  LoopGuard guard(kNames);
  std::array<pollfd, 4> files{{{-1, POLLIN, 0}, {3, POLLIN, POLLIN}, {4, POLLIN, POLLHUP}, {5, POLLIN, 0}}};
  guard.polled(files);
  EXPECT_EQ(guard.hangs_at(), "");
  files[3].revents = POLLNVAL;
  guard.polled(files);
  EXPECT_NE(guard.hangs_at().find("client"), std::string::npos) << guard.hangs_at();
}

}  // namespace
}  // namespace odomcalib::loop_guard_test
