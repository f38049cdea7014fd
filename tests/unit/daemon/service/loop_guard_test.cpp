#include "daemon/service/loop_watch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <span>

#include "daemon/service/settings.hpp"

namespace odomcalib::loop_guard_test {
namespace {

constexpr std::array kNames = {"base", "lidar", "client"};
constexpr std::size_t kMost = service::settings::kMostIdleTurns;

constexpr std::array<std::uint64_t, kNames.size()> kNothing{};
constexpr std::array<pollfd, 4> kQuiet{{{-1, POLLIN, 0}, {3, POLLIN, 0}, {4, POLLIN, 0}, {5, POLLIN, 0}}};

TEST(LoopGuard, names_calls_that_wait_and_are_never_served) {
  LoopGuard guard(kNames);
  for (std::size_t i = 0; i + 1 < kMost; ++i) guard.turned(true, false, kNothing);
  EXPECT_EQ(guard.hangs_at(), "");
  guard.turned(true, false, kNothing);
  EXPECT_NE(guard.hangs_at().find("client"), std::string::npos) << guard.hangs_at();
}

TEST(LoopGuard, finds_nothing_in_a_flood_that_is_served_or_in_turns_that_wait) {
  LoopGuard guard(kNames);
  for (std::size_t i = 0; i < 3 * kMost; ++i) guard.turned(true, i % (kMost - 1) == 0, kNothing);
  for (std::size_t i = 0; i < 3 * kMost; ++i) guard.turned(false, false, kNothing);
  EXPECT_EQ(guard.hangs_at(), "");
}

TEST(LoopGuard, names_a_descriptor_that_is_not_open) {
  LoopGuard guard(kNames);
  std::array<pollfd, 4> files{{{-1, POLLIN, 0}, {3, POLLIN, POLLIN}, {4, POLLIN, POLLHUP}, {5, POLLIN, 0}}};
  guard.polled(files, 2);
  EXPECT_EQ(guard.hangs_at(), "");
  files[3].revents = POLLNVAL;
  guard.polled(files, 3);
  EXPECT_NE(guard.hangs_at().find("client"), std::string::npos) << guard.hangs_at();
}

/// Turns of a loop that is woken by these and takes so much from each a turn.
void turn(LoopGuard& guard, std::size_t times, std::span<const pollfd> woken,
          std::array<std::uint64_t, kNames.size()> each) {
  static std::array<std::uint64_t, kNames.size()> taken{};
  for (std::size_t i = 0; i < times; ++i) {
    for (std::size_t k = 0; k < taken.size(); ++k) taken[k] += each[k];
    guard.polled(woken, 1);
    guard.turned(false, false, taken);
  }
}

TEST(LoopGuard, names_what_wakes_the_loop_and_is_not_taken) {
  LoopGuard guard(kNames);
  auto woken = kQuiet;
  woken[1].revents = POLLIN;
  turn(guard, kMost, woken, {1, 1, 0});
  turn(guard, kMost - 1, woken, {1, 0, 1});
  EXPECT_EQ(guard.hangs_at(), "");
  turn(guard, 1, woken, {1, 0, 1});
  EXPECT_NE(guard.hangs_at().find("lidar: it wakes"), std::string::npos) << guard.hangs_at();
}

TEST(LoopGuard, finds_nothing_in_what_wakes_it_now_and_then_or_is_taken) {
  LoopGuard guard(kNames);
  auto woken = kQuiet;
  woken[1].revents = POLLIN;
  for (int i = 0; i < 10; ++i) {
    turn(guard, kMost - 1, woken, {0, 0, 0});
    turn(guard, 1, kQuiet, {0, 0, 0});
  }
  turn(guard, 10 * kMost, woken, {0, 1, 0});
  EXPECT_EQ(guard.hangs_at(), "");
}

TEST(LoopGuard, names_a_wait_that_fails_and_is_no_signal) {
  LoopGuard guard(kNames);
  errno = EINTR;
  guard.polled(kQuiet, -1);
  EXPECT_EQ(guard.hangs_at(), "");
  errno = EINVAL;
  guard.polled(kQuiet, -1);
  EXPECT_NE(guard.hangs_at().find("waiting: Invalid"), std::string::npos) << guard.hangs_at();
}

}  // namespace
}  // namespace odomcalib::loop_guard_test
