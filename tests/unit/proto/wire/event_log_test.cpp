#include "proto/wire/event_log.hpp"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>

#include <random>

#include "proto/recording/recording_log.hpp"
#include "proto/wire/messages.hpp"
#include "tests/unit/proto/support.hpp"

namespace odomcalib::event_log_test {
namespace {

using messages::Stamp;
using test::discarded;
using test::list_discarded;

std::string big_endian(std::uint64_t value, std::size_t size) {
  std::string out;
  for (std::size_t i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * (size - 1 - i)));
  return out;
}

std::string event(const std::string& channel, const std::string& data, std::int64_t number = 0) {
  return "\xED\xA1\xDA\x01" + big_endian(static_cast<std::uint64_t>(number), 8) + big_endian(1000, 8) +
         big_endian(channel.size(), 4) + big_endian(data.size(), 4) + channel + data;
}

Stamp at(double t) { return {static_cast<std::int64_t>(t * 1e6), static_cast<std::int64_t>(t * 1e9)}; }

std::string ticks(double t, std::int64_t left) {
  return event("ODOMCALIB_TICKS", messages::encode(at(t), TickSample{0, left, left, 0}));
}

std::string robot() { return event("ODOMCALIB_ROBOT", messages::encode(0, test::example_robot())); }

std::size_t count_events(EventLogReader& log) {
  std::size_t events = 0;
  while (log.next()) ++events;
  return events;
}

void expect_all_bytes_accounted(const EventLogReader& log, std::size_t bytes) {
  EXPECT_EQ(bytes, log.counters().good + log.counters().skipped + log.counters().cut_off);
}

TEST(EventLog, finds_every_event_behind_garbage) {
  const std::string bytes = "garbage" + event("A", "1") + std::string("\xED\xA1\xDA\x01 more", 9) +
                            event("B", "") + "\xED\xA1" + event("C", "333");
  EventLogReader log(bytes);
  EXPECT_EQ(log.next()->channel, "A");
  EXPECT_EQ(log.next()->channel, "B");
  EXPECT_EQ(log.next()->data, "333");
  EXPECT_FALSE(log.next());
  EXPECT_EQ(log.counters().skipped, 7U + 9U + 2U);
  EXPECT_EQ(log.counters().garbage, 3U);
  expect_all_bytes_accounted(log, bytes.size());
}

TEST(EventLog, cut_off_at_any_byte_gives_the_whole_events_before) {
  const std::string first = event("A", "12345");
  const std::string second = event("BB", "6789");
  for (std::size_t size = 0; size <= first.size() + second.size(); ++size) {
    const std::string bytes = (first + second).substr(0, size);
    EventLogReader log(bytes);
    EXPECT_EQ(count_events(log), size < first.size()                   ? 0U
                                 : size < first.size() + second.size() ? 1U
                                                                       : 2U)
        << size;
    expect_all_bytes_accounted(log, size);
  }
}

TEST(EventLog, with_a_damaged_length_loses_that_event_only) {
  for (const std::size_t position : {20U, 24U}) {
    for (const std::uint32_t value : {0U, 64U, 1000U, 0x7fffffffU, 0xffffffffU}) {
      std::string damaged = event("B", std::string(100, 'x'));
      damaged.replace(position, 4, big_endian(value, 4));
      const std::string bytes =
          event("A", "1") + damaged + event("C", "3") + event("D", std::string(2000, 'y'));
      EventLogReader log(bytes);
      std::string channels;
      while (const auto found = log.next())
        if (found->data.size() != 0 || value != 0) channels += std::string(found->channel.substr(0, 1));
      EXPECT_TRUE(channels == "ACD" || channels == "ABCD")
          << channels << " at " << position << " value " << value;
      expect_all_bytes_accounted(log, bytes.size());
    }
  }
}

TEST(EventLog, accounts_for_every_byte_of_random_logs) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 300; ++round) {
    std::string bytes;
    for (int i = 0; i < 10; ++i) {
      bytes += event("CH", std::string(random() % 40, 'x'));
      if (random() % 3 == 0) bytes += std::string(random() % 20, static_cast<char>(random()));
    }
    for (int i = 0; i < 5; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % bytes.size());
    EventLogReader log(bytes);
    EXPECT_LE(count_events(log), 10U);
    expect_all_bytes_accounted(log, bytes.size());
  }
}

Result<Recording> read_log(const std::string& bytes, const RobotDescription* fallback = nullptr) {
  return test::read_text(bytes, fallback);
}

TEST(NativeLog, is_read_with_its_robot_and_monotonic_times) {
  const auto result = value_of(read_log(robot() + ticks(2.5, 7) + robot()));
  EXPECT_EQ(result.robot.ticks_per_rev, 2000.0);
  ASSERT_EQ(result.ticks.size(), 1U);
  EXPECT_EQ(result.ticks[0].t, 2.5);
  EXPECT_TRUE(result.discarded.empty()) << list_discarded(result);
}

TEST(NativeLog, needs_a_robot_message_or_a_fallback) {
  EXPECT_EQ(read_log(ticks(0, 0)).error().code, ErrorCode::missing_units);
  const auto fallback = test::example_robot();
  EXPECT_TRUE(read_log(ticks(0, 0), &fallback).ok());
}

// Dead reckoning that the daemon publishes has the type of the external reference.
TEST(NativeLog, takes_poses_from_the_reference_channel_only) {
  const auto pose = [](const char* channel) {
    return event(channel, messages::encode(at(1), PoseSample{0, 1, 2, 3}));
  };
  const auto result =
      value_of(read_log(robot() + ticks(0, 0) + pose("ODOMCALIB_ODOM") + pose("ODOMCALIB_ODOM_CALIBRATED")));
  EXPECT_TRUE(result.poses.empty());
  EXPECT_EQ(read_log(robot() + pose("R2_POSE_REF")).value().poses.size(), 1U);
}

TEST(NativeLog, lists_what_it_does_not_know_and_counts_damaged_messages) {
  Scan scan;
  scan.angle_increment = 0.1;
  scan.ranges = {1.0F};
  const auto r = value_of(read_log(
      robot() + ticks(0, 0) + event("X", big_endian(0x1234, 8) + "data") + event("Y", "short") +
      event("ODOMCALIB_TICKS", messages::encode(at(1), TickSample{}).substr(0, 20)) +
      event("ODOMCALIB_SCAN", messages::encode(at(1), scan, {}, false)) +
      event("ODOMCALIB_STATUS", messages::encode_json(0, "f", "{}")) + "junk" + ticks(1, 1).substr(0, 40)));
  EXPECT_EQ(r.ticks.size(), 1U);
  EXPECT_EQ(discarded(r, "event", "unknown fingerprint 0x0000000000001234"), 1U) << list_discarded(r);
  EXPECT_EQ(discarded(r, "event", "unknown fingerprint 0x0000000000000000"), 1U);
  EXPECT_EQ(discarded(r, "ticks", "damaged message"), 1U);
  EXPECT_EQ(discarded(r, "scan", "incomplete"), 1U);
  EXPECT_EQ(discarded(r, "event", "not needed: json_t"), 1U);
  EXPECT_EQ(discarded(r, "byte", "between events"), 4U);
  EXPECT_EQ(discarded(r, "event", "cut off"), 1U);
}

std::filesystem::path fresh_path(const char* name) {
  auto path = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove(path);
  return path;
}

TEST(RecordingLog, gives_back_what_was_written_and_is_read_by_the_lcm_library) {
  const auto path = fresh_path("recording_log.lcm");
  auto log = value_of(RecordingLog::create(path, "R1_"));
  Scan scan;
  scan.angle_min = -1.0;
  scan.angle_increment = 0.5;
  scan.ranges = {1.5F, 0.0F, 2.5F};
  scan.range_max = 8.0;
  scan.sensor = "front left";
  ASSERT_TRUE(log.robot(1, test::example_robot()).ok());
  ASSERT_TRUE(log.ticks(at(1), {0, 1, 2, 0}).ok());
  ASSERT_TRUE(log.scan(at(1), scan).ok());
  ASSERT_TRUE(log.pose(at(1), {0, 1, 2, 3}).ok());
  ASSERT_TRUE(log.gyro(at(1), {0, 0.5}).ok());
  ASSERT_TRUE(log.event(at(1), messages::Severity::fault, "E", "text").ok());
  ASSERT_TRUE(log.json(1, "RESULT", "f", "{}").ok());
  ASSERT_TRUE(log.flush(true).ok());
  EXPECT_EQ(log.events(), 7U);
  EXPECT_EQ(log.bytes(), std::filesystem::file_size(path));

  const auto back = value_of(read_recording(path));
  EXPECT_EQ(back.ticks.at(0).right, 2);
  EXPECT_EQ(back.scans.at(0).ranges, scan.ranges);
  EXPECT_EQ(back.poses.at(0).yaw, 3.0);
  EXPECT_EQ(back.gyro.at(0).yaw_rate, 0.5);

  lcm_eventlog_t* library = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(library, nullptr);
  std::vector<std::string> channels;
  while (lcm_eventlog_event_t* found = lcm_eventlog_read_next_event(library)) {
    channels.emplace_back(found->channel, static_cast<std::size_t>(found->channellen));
    lcm_eventlog_free_event(found);
  }
  lcm_eventlog_destroy(library);
  EXPECT_EQ(channels, (std::vector<std::string>{"R1_ROBOT", "R1_TICKS", "R1_SCAN_FRONT_LEFT", "R1_POSE_REF",
                                                "R1_GYRO", "R1_EVENT", "R1_RESULT"}));
}

TEST(RecordingLog, does_not_overwrite_and_refuses_long_channels) {
  const auto path = fresh_path("recording_log_once.lcm");
  auto first = value_of(RecordingLog::create(path));
  EXPECT_EQ(RecordingLog::create(path).error().code, ErrorCode::io);
  EXPECT_EQ(RecordingLog::create("/nonexistent/x.lcm").error().code, ErrorCode::io);
  EXPECT_TRUE(first.write(0, std::string(63, 'A'), "x").ok());
  EXPECT_EQ(first.write(0, std::string(64, 'A'), "x").error().code, ErrorCode::usage);
  EXPECT_EQ(first.write(0, "", "x").error().code, ErrorCode::usage);
}

TEST(RecordingLog, reports_a_full_disk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const auto path = fresh_path("recording_log_full.lcm");
  std::filesystem::create_symlink("/dev/full", path);
  EXPECT_FALSE(RecordingLog::create(path).ok()) << "existing names are never reused, links included";
  std::filesystem::remove(path);
}

// Angles and ranges travel as float, times as whole nanoseconds: everything else is the same.
TEST(RecordingLog, of_a_json_lines_recording_gives_equal_data) {
  ODOMCALIB_SHARED_FILE(source, "maebot/convex.jsonl.gz");
  const auto a = value_of(read_recording(source));
  const auto path = fresh_path("convex.lcm");
  ASSERT_TRUE(write_recording_log(a, path).ok());
  const auto b = value_of(read_recording(path));
  EXPECT_TRUE(b.discarded.empty()) << list_discarded(b);
  EXPECT_EQ(a.robot.ticks_per_rev, b.robot.ticks_per_rev);
  EXPECT_EQ(a.robot.lidar_pose, b.robot.lidar_pose);
  ASSERT_EQ(a.ticks.size(), b.ticks.size());
  ASSERT_EQ(a.scans.size(), b.scans.size());
  for (std::size_t i = 0; i < a.ticks.size(); ++i) {
    EXPECT_NEAR(a.ticks[i].t, b.ticks[i].t, 1e-9);
    EXPECT_EQ(a.ticks[i].left, b.ticks[i].left);
    EXPECT_EQ(a.ticks[i].right, b.ticks[i].right);
  }
  for (std::size_t i = 0; i < a.scans.size(); ++i) {
    EXPECT_NEAR(a.scans[i].t, b.scans[i].t, 1e-9);
    EXPECT_EQ(a.scans[i].ranges, b.scans[i].ranges);
    EXPECT_EQ(a.scans[i].angles, b.scans[i].angles);
    EXPECT_EQ(a.scans[i].times, b.scans[i].times);
    EXPECT_FLOAT_EQ(static_cast<float>(a.scans[i].angle_increment),
                    static_cast<float>(b.scans[i].angle_increment));
  }
}

}  // namespace
}  // namespace odomcalib::event_log_test
