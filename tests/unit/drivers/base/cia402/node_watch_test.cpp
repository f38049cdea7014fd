// The supervision of a node by itself: frames and time in, findings out.
#include <gtest/gtest.h>

#include <initializer_list>

#include "drivers/base/cia402/node_watch.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers::node_watch_test {
namespace {

constexpr std::uint32_t kLifeSign = 0x701, kRequest = 0x601;

CanFrame frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

class NodeWatch : public testing::Test {
 protected:
  Profile profile_ = read_profile("drivers/base/profiles/sim-dual.toml").value();
  drivers::NodeWatch watch_{profile_};
  const drivers::NodeWatch::Situation new_to_us_{.new_to_us = true};
  const drivers::NodeWatch::Situation ready_{.ready = true};
  const drivers::NodeWatch::Situation moving_{.ready = true, .moving = true};
};

TEST_F(NodeWatch, three_life_signs_may_be_missing_unless_the_node_stores) {
  watch_.on_life_sign(frame_of(kLifeSign, {0x05}), ready_, 1.0);
  EXPECT_FALSE(watch_.check(ready_, 1.089).lost);
  EXPECT_FALSE(watch_.check({.ready = true, .storing = true}, 1.2).lost);
  EXPECT_FALSE(watch_.check(new_to_us_, 1.2).lost);
  const auto finding = watch_.check(ready_, 1.2);
  EXPECT_TRUE(finding.lost);
  ASSERT_TRUE(finding.event);
  EXPECT_EQ(finding.event->code, "heartbeat_lost");
}

TEST_F(NodeWatch, a_boot_up_is_a_loss_of_a_node_in_use_and_news_of_one_that_fell_silent) {
  const CanFrame boot = frame_of(kLifeSign, {0x00});
  const auto expected = watch_.on_life_sign(boot, new_to_us_, 1.0);
  EXPECT_TRUE(expected.booted);
  EXPECT_FALSE(expected.event);
  EXPECT_TRUE(watch_.on_life_sign(boot, ready_, 2.0).lost);
  EXPECT_TRUE(watch_.check(ready_, 3.0).lost);
  const auto back = watch_.on_life_sign(boot, new_to_us_, 4.0);
  EXPECT_FALSE(back.lost);
  ASSERT_TRUE(back.event);
  EXPECT_FALSE(back.event->stop);
  EXPECT_FALSE(watch_.on_life_sign(boot, new_to_us_, 5.0).event) << "told once";
}

TEST_F(NodeWatch, who_only_reads_the_node_commands_nothing) {
  const auto reads =
      watch_.on_other_master(frame_of(kRequest, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0}), moving_, 10.0);
  ASSERT_TRUE(reads.event);
  EXPECT_FALSE(reads.event->stop);
  EXPECT_FALSE(watch_.was_commanded());
  EXPECT_FALSE(watch_.touched());
  EXPECT_TRUE(watch_.other_master(10.1));
  const auto writes =
      watch_.on_other_master(frame_of(kRequest, {0x23, 0xFF, 0x60, 1, 0, 0, 0, 0}), moving_, 10.1);
  ASSERT_TRUE(writes.event);
  EXPECT_TRUE(writes.event->stop);
  EXPECT_TRUE(watch_.was_commanded());
  EXPECT_EQ(watch_.touched(), 10.1);
}

TEST_F(NodeWatch, what_others_changed_is_open_until_a_reading_that_began_later) {
  watch_.on_other_master(frame_of(0x000, {0x80, 0x01}), ready_, 10.0);
  watch_.was_read(10.0);
  EXPECT_TRUE(watch_.touched());
  watch_.was_read(10.1);
  EXPECT_FALSE(watch_.touched());
}

TEST_F(NodeWatch, our_life_sign_comes_every_twenty_milliseconds) {
  const auto first = watch_.take_heartbeat(1.0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->id, 0x77FU);
  EXPECT_FALSE(watch_.take_heartbeat(1.019));
  EXPECT_TRUE(watch_.take_heartbeat(1.0201));
}

}  // namespace
}  // namespace odomcalib::drivers::node_watch_test
