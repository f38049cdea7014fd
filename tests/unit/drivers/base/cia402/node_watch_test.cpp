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
  const drivers::NodeWatch::Situation in_a_job_{.ready = true, .job = true};
  const drivers::NodeWatch::Situation fresh_{.ready = true, .fresh = true};
  const CanFrame pre_operational_ = frame_of(kLifeSign, {0x7F});
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

TEST_F(NodeWatch, what_it_answers_and_sends_is_a_sign_of_life_while_a_job_runs_and_not_otherwise) {
  for (const bool by_answer : {true, false})
    for (const auto& node : {in_a_job_, ready_, moving_}) {
      watch_.heard(1.0);
      if (by_answer)
        watch_.on_answer(node, 1.08);
      else
        watch_.on_process_data(node, 1.08);
      EXPECT_EQ(watch_.check(node, 1.16).lost, !node.job);
      EXPECT_TRUE(watch_.check(node, 1.18).lost) << "it has gone silent";
    }
}

TEST_F(NodeWatch, a_life_sign_of_another_state_is_an_old_one_when_process_data_follow) {
  for (const auto& node : {in_a_job_, fresh_}) {
    EXPECT_FALSE(watch_.on_life_sign(pre_operational_, node, 1.00).lost);
    watch_.on_process_data(node, 1.02);
    watch_.on_life_sign(frame_of(kLifeSign, {0x05}), node, 1.09);
    EXPECT_FALSE(watch_.check(node, 1.15).lost);
    EXPECT_FALSE(watch_.check(moving_, 1.15).lost);
  }
}

TEST_F(NodeWatch, a_life_sign_of_another_state_is_believed_after_100_ms_without_process_data) {
  for (const auto& node : {in_a_job_, fresh_}) {
    EXPECT_FALSE(watch_.on_life_sign(pre_operational_, node, 1.00).lost);
    EXPECT_FALSE(watch_.on_life_sign(pre_operational_, node, 1.03).lost);
    watch_.on_life_sign(pre_operational_, node, 1.06);
    EXPECT_FALSE(watch_.check(node, 1.099).lost);
    const auto finding = watch_.check(node, 1.101);
    EXPECT_TRUE(finding.lost);
    ASSERT_TRUE(finding.event);
    EXPECT_EQ(finding.event->code, "left_operational");
    EXPECT_FALSE(watch_.check(node, 1.11).lost) << "told once";
  }
}

TEST_F(NodeWatch, a_life_sign_of_another_state_is_believed_at_once_when_torque_is_wanted) {
  EXPECT_TRUE(watch_.on_life_sign(pre_operational_, ready_, 1.0).lost);
  EXPECT_TRUE(watch_.on_life_sign(pre_operational_, moving_, 2.0).lost);
  EXPECT_FALSE(watch_.on_life_sign(pre_operational_, fresh_, 3.0).lost);
  EXPECT_TRUE(watch_.check({.ready = true, .moving = true, .fresh = true}, 3.001).lost);
  EXPECT_TRUE(
      watch_.on_life_sign(pre_operational_, {.ready = true, .moving = true, .fresh = true}, 4.0).lost);
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
