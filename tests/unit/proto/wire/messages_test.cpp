#include "proto/wire/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <odomcalib/event_t.hpp>
#include <odomcalib/gyro_t.hpp>
#include <odomcalib/json_t.hpp>
#include <odomcalib/path_t.hpp>
#include <odomcalib/pose_t.hpp>
#include <odomcalib/robot_t.hpp>
#include <odomcalib/scan_t.hpp>
#include <odomcalib/ticks_t.hpp>

namespace odomcalib::messages::messages_test {
namespace {

constexpr Stamp kStamp{1'700'000'000'123'456, 987'654'321'012};

Scan example_scan() {
  Scan scan;
  scan.sensor = "front";
  scan.angle_min = -0.5;
  scan.angle_increment = 0.25;
  scan.time_increment = 0.125;
  scan.range_min = 0.0625;
  scan.range_max = 8.5;
  scan.ranges = {1.1F, 0.0F, 3.3F};
  scan.angles = {0.1F, 0.2F, 0.3F};
  scan.times = {0.0F, 0.01F, 0.02F};
  scan.intensities = {7.0F, 8.0F, 9.0F};
  return scan;
}

// Changing a definition would make every old recording unreadable.
TEST(Messages, have_the_published_fingerprints) {
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::robot_t::getHash()), 0xe7b341c5f97392eeU);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::ticks_t::getHash()), 0x1e7ffc7532290eb9U);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::scan_t::getHash()), 0x179f2043430ed99cU);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::pose_t::getHash()), 0x28e47ebeb05766e2U);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::gyro_t::getHash()), 0xc722c864341443f5U);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::path_t::getHash()), 0xf74c516dcc36f819U);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::event_t::getHash()), 0x96fceb71ae149523U);
  EXPECT_EQ(static_cast<std::uint64_t>(odomcalib::json_t::getHash()), 0xe560d2700a250ff9U);
  EXPECT_EQ(fingerprint(encode(kStamp, TickSample{})), kTicksFingerprint);
  EXPECT_EQ(fingerprint("short"), std::nullopt);
}

TEST(Messages, survive_encoding) {
  const RobotDescription robot{0.1, 0.2, 0.3, 2796.8, std::array<double, 3>{1, 2, 3}, "r", "c [d]", "e/1/2"};
  const auto robot_back = decode_robot(encode(5, robot));
  ASSERT_TRUE(robot_back);
  EXPECT_EQ(robot_back->right_wheel_diameter, 0.2);
  EXPECT_EQ(robot_back->lidar_pose, robot.lidar_pose);
  EXPECT_EQ(robot_back->controller, "c [d]");
  EXPECT_EQ(robot_back->controller_id, "e/1/2");
  RobotDescription unknown;
  unknown.controller = "c";  // of a controller that does not say which it is
  EXPECT_EQ(decode_robot(encode(5, unknown))->controller, "c");
  EXPECT_EQ(decode_robot(encode(5, unknown))->controller_id, "");

  const auto ticks =
      decode_ticks(encode(kStamp, TickSample{0, -5, 1LL << 40, 3}, {9, TimeSource::sync_echo, 250}));
  ASSERT_TRUE(ticks);
  EXPECT_EQ(ticks->stamp.utime, kStamp.utime);
  EXPECT_EQ(ticks->ticks.t, 987.654321012);
  EXPECT_EQ(ticks->ticks.left, -5);
  EXPECT_EQ(ticks->ticks.right, 1LL << 40);
  EXPECT_EQ(ticks->ticks.segment, 3);
  EXPECT_EQ(ticks->origin.seq, 9);
  EXPECT_EQ(ticks->origin.time_source, TimeSource::sync_echo);
  EXPECT_EQ(ticks->origin.time_uncertainty_us, 250);

  const auto scan = decode_scan(encode(kStamp, example_scan(), {}, false));
  ASSERT_TRUE(scan);
  EXPECT_FALSE(scan->complete);
  EXPECT_EQ(scan->scan.sensor, "front");
  EXPECT_EQ(scan->scan.angle_increment, 0.25);
  EXPECT_EQ(scan->scan.time_increment, 0.125);
  EXPECT_EQ(scan->scan.ranges, example_scan().ranges);
  EXPECT_EQ(scan->scan.angles, example_scan().angles);
  EXPECT_EQ(scan->scan.times, example_scan().times);
  EXPECT_EQ(scan->scan.intensities, example_scan().intensities);

  EXPECT_EQ(decode_pose(encode(kStamp, PoseSample{0, 1, 2, 3}))->pose.yaw, 3.0);
  EXPECT_EQ(decode_gyro(encode(kStamp, GyroSample{0, -0.5}))->gyro.yaw_rate, -0.5);
  const auto event = decode_event(encode_event(kStamp, Severity::stop, "E1", "text"));
  ASSERT_TRUE(event);
  EXPECT_EQ(event->severity, Severity::stop);
  EXPECT_EQ(event->text, "text");
  EXPECT_EQ(decode_json(encode_json(1, "f", "{}"))->json, "{}");
}

// Our decoders and those of lcm-gen must agree on good messages.
TEST(Messages, are_read_by_the_generated_types) {
  const auto bytes = encode(kStamp, example_scan(), {4, TimeSource::hardware, 10});
  odomcalib::scan_t generated{};
  ASSERT_EQ(generated.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  EXPECT_EQ(generated.ranges, example_scan().ranges);
  EXPECT_EQ(generated.sensor, "front");
  EXPECT_EQ(generated.time_source, 3);
  const auto path_bytes = encode_path(7, "scan", {{0, 1, 2, 3}, {1, 4, 5, 6}});
  odomcalib::path_t path{};
  ASSERT_EQ(path.decode(path_bytes.data(), 0, static_cast<int>(path_bytes.size())),
            static_cast<int>(path_bytes.size()));
  EXPECT_EQ(path.n, 2);
  EXPECT_EQ(path.yaw[1], 6.0);
}

TEST(Messages, carry_no_nan_no_infinity_and_no_text_behind_a_nul) {
  auto scan = example_scan();
  scan.ranges = {NAN, INFINITY, 1.0F};
  scan.angle_min = NAN;
  scan.range_max = 1e300;
  scan.sensor = std::string("a\0b", 3);
  const auto back = decode_scan(encode(kStamp, scan));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->scan.ranges, (std::vector<float>{0.0F, 0.0F, 1.0F}));
  EXPECT_EQ(back->scan.angle_min, 0.0);
  EXPECT_EQ(back->scan.range_max, 0.0);
  EXPECT_EQ(back->scan.sensor, "a");
  EXPECT_EQ(decode_pose(encode(kStamp, PoseSample{0, NAN, INFINITY, 1}))->pose.x, 0.0);
}

TEST(Messages, a_scan_whose_last_beam_is_sent_first_says_so) {
  Scan scan = example_scan();
  scan.time_increment = -0.25;
  const auto back = decode_scan(encode(kStamp, scan));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->scan.time_increment, -0.25);
}

TEST(Messages, are_refused_at_every_other_length) {
  const auto bytes = encode(kStamp, example_scan());
  ASSERT_TRUE(decode_scan(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_scan(bytes.substr(0, size))) << size;
  EXPECT_FALSE(decode_scan(bytes + "x"));
  EXPECT_FALSE(decode_ticks(bytes)) << "another fingerprint";
}

/// Replaces four bytes by a big-endian number.
std::string with_int32(std::string bytes, std::size_t at, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    bytes[at + i] = static_cast<char>(static_cast<std::uint32_t>(value) >> (24U - 8U * i));
  return bytes;
}

TEST(Messages, with_impossible_lengths_are_refused_without_allocating_them) {
  auto scan = example_scan();
  scan.sensor.clear();
  const auto bytes = encode(kStamp, scan);
  constexpr std::size_t kTextLength = 8 + 16 + 4;
  constexpr std::size_t kRanges = kTextLength + 4 + 1 + std::size_t{5} * 4;
  ASSERT_TRUE(decode_scan(with_int32(bytes, kTextLength, 1)));
  for (const std::int32_t length : {0, -1, 2, INT32_MAX, INT32_MIN})
    EXPECT_FALSE(decode_scan(with_int32(bytes, kTextLength, length))) << length;
  ASSERT_TRUE(decode_scan(with_int32(bytes, kRanges, 3)));
  for (const std::int32_t length : {-1, INT32_MIN, INT32_MAX, 1 << 30, 2, 4})
    EXPECT_FALSE(decode_scan(with_int32(bytes, kRanges, length))) << length;
}

}  // namespace
}  // namespace odomcalib::messages::messages_test
