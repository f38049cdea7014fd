// Stamps of ROS recordings that are no times: without their last digits, or of a clock that was set
// meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_times_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::add_joints;
using test::all_told;
using test::kMillisecond_ns;
using test::kRosStart;
using test::read_ros;
using test::small_drive;
using test::small_log;
using test::told;

constexpr std::int64_t kSecond_ns = 1'000 * kMillisecond_ns;

/// Joint states whose stamps are made of the true time and the number of the message.
template <typename Stamp>
RosLog stamped(Stamp stamp) {
  RosLog log = test::without_topic(small_log(Wire::cdr_little), "/joint_states");
  for (int k = 0; k < 200; ++k) {
    const std::int64_t time = kRosStart + 20 * kMillisecond_ns * k;
    log.add("/joint_states", "sensor_msgs/JointState", time + 3 * kMillisecond_ns,
            encode_joints(log.wire, {stamp(time, k), ""}, {"left", "right"}, {0.1 * k, 0.11 * k}, {}));
  }
  return log;
}

void expect_reception(const RosLog& log, const std::string& reason) {
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_TRUE(told(found, "times of reception: the stamps of /joint_states " + reason))
      << all_told(found.choices);
  ASSERT_EQ(found.ticks.size(), 200U) << test::list_discarded(found);
  EXPECT_NEAR(found.ticks.back().t - found.ticks.front().t, 3.98, 1e-6);
  ASSERT_EQ(found.scans.size(), 40U);
  EXPECT_NEAR(found.scans.front().t, found.ticks.front().t, 0.1);
}

void expect_stamps(const RosLog& log) {
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_FALSE(told(found, "times of reception")) << all_told(found.choices);
  EXPECT_FALSE(told(found, "lost their last digits"));
  EXPECT_EQ(found.ticks[1].t, 0.02);
  EXPECT_EQ(found.time_zero, static_cast<double>(kRosStart / kSecond_ns));
}

TEST(RosTimes, that_are_sound_are_the_stamps) {
  expect_stamps(stamped([](std::int64_t time, int) { return time; }));
}

TEST(RosTimes, of_stamps_without_their_last_digits_are_those_of_reception) {
  expect_reception(stamped([](std::int64_t time, int) { return time / kSecond_ns * kSecond_ns; }),
                   "have lost their last digits: 196 of 199");
  // Simulated time that goes on ten times a second.
  constexpr std::int64_t kTenth = kSecond_ns / 10;
  expect_reception(stamped([](std::int64_t time, int) { return time / kTenth * kTenth; }), "have lost");
  expect_reception(stamped([](std::int64_t, int) { return kRosStart; }),
                   "have lost their last digits: 199 of 199");
}

TEST(RosTimes, of_messages_that_came_twice_are_the_stamps) {
  RosLog log = stamped([](std::int64_t time, int) { return time; });
  const auto messages = log.messages;
  for (const auto& message : messages)
    for (int again = 0; again < 3; ++again) log.messages.push_back(message);
  std::stable_sort(log.messages.begin(), log.messages.end(),
                   [](const auto& a, const auto& b) { return a.received_ns < b.received_ns; });
  expect_stamps(log);
}

/// Lidars that are fired at once.
TEST(RosTimes, of_several_publishers_that_share_their_stamps_are_the_stamps) {
  RosLog log = small_log(Wire::cdr_little);
  for (const Scan& scan : small_drive().scans)
    for (const char* frame : {"left", "right", "rear"}) {
      Scan other = scan;
      other.ranges[0] = static_cast<float>(frame[0]) / 100.0F;
      const std::int64_t time = kRosStart + std::llround(1e9 * scan.t);
      log.add("/scan", "sensor_msgs/LaserScan", time + 40 * kMillisecond_ns,
              encode_scan(log.wire, {time, frame}, other));
    }
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_FALSE(told(found, "times of reception")) << all_told(found.choices);
  EXPECT_EQ(found.scans.size(), 160U);
}

TEST(RosTimes, of_a_clock_that_was_set_meanwhile_are_those_of_reception) {
  const auto since_boot = [](std::int64_t time) { return time - kRosStart + 5 * kSecond_ns; };
  expect_reception(stamped([&](std::int64_t time, int k) { return k < 60 ? since_boot(time) : time; }),
                   "jump by 1699999995 s");
  expect_reception(stamped([&](std::int64_t time, int k) { return k < 140 ? since_boot(time) : time; }),
                   "jump by 1699999995 s");
  // Two programs, one of which never got the date.
  expect_reception(stamped([&](std::int64_t time, int k) { return k % 3 == 0 ? since_boot(time) : time; }),
                   "jump by 1699999995 s");
  // A clock without a battery.
  expect_reception(
      stamped([](std::int64_t time, int k) { return k < 30 ? time - 1'400'000'000 * kSecond_ns : time; }),
      "jump by 1400000000 s");
}

TEST(RosTimes, of_single_wild_stamps_are_the_stamps) {
  const RosLog log = stamped(
      [](std::int64_t time, int k) { return k % 40 == 39 ? time - 1'600'000'000 * kSecond_ns : time; });
  expect_stamps(log);
  EXPECT_EQ(value_of(read_ros(write_mcap(log))).ticks.size(), 195U);
}

/// Played back with a pause, the stamps are still those of one clock.
TEST(RosTimes, of_a_recording_that_was_played_back_with_a_pause_are_the_stamps) {
  RosLog log = small_log(Wire::cdr_little);
  for (auto& message : log.messages)
    if (message.received_ns > kRosStart + 2 * kSecond_ns) message.received_ns += 3'600 * kSecond_ns;
  expect_stamps(log);
}

/// A simulation that begins at time 0, which stands for no stamp.
TEST(RosTimes, of_single_messages_without_a_stamp_are_between_those_of_their_neighbours) {
  for (const char* topic : {"/scan", "/joint_states", "/odom"})
    for (const std::size_t wrong : {std::size_t{0}, std::size_t{7}}) {
      Recording drive = small_drive();
      for (Scan& scan : drive.scans) scan.t -= drive.scans.front().t;
      const bool odometry = topic == std::string("/odom");
      const RosLog stamped_log =
          sim::ros_log(drive, {.wire = Wire::ros1, .joints = !odometry, .start_ns = 0});
      RosLog log = stamped_log;
      std::size_t k = 0;
      for (auto& message : log.messages) {
        message.received_ns += kRosStart;
        // The stamp follows the sequence number.
        if (log.topics[message.topic].name == topic && k++ == wrong) message.bytes.replace(4, 8, 8, '\0');
      }
      const auto found = value_of(read_ros(write_bag(log)));
      const auto twin = value_of(read_ros(write_bag(stamped_log)));
      EXPECT_TRUE(told(found, std::string(topic) + (wrong == 0 ? ": 1 of " : ": 2 of ")))
          << all_told(found.choices);
      EXPECT_FALSE(told(found, "times of reception"));
      ASSERT_EQ(found.ticks.size(), twin.ticks.size()) << test::list_discarded(found);
      ASSERT_EQ(found.scans.size(), 40U);
      for (std::size_t i = 0; i < found.ticks.size(); ++i)
        EXPECT_NEAR(found.ticks[i].t + found.time_zero, twin.ticks[i].t + twin.time_zero, 1e-6);
      for (std::size_t i = 0; i < found.scans.size(); ++i)
        EXPECT_NEAR(found.scans[i].t + found.time_zero, twin.scans[i].t + twin.time_zero, 1e-6);
    }
}

TEST(RosTimes, of_reception_that_are_no_better_are_not_taken) {
  RosLog log = stamped([](std::int64_t time, int) { return time / kSecond_ns * kSecond_ns; });
  for (auto& message : log.messages) message.received_ns = message.received_ns / kSecond_ns * kSecond_ns;
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_FALSE(told(found, "times of reception:"));
  EXPECT_TRUE(told(found, "the times of reception are no better"));
}

}  // namespace
}  // namespace odomcalib::ros_times_test
