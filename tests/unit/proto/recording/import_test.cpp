// Recordings of others: MaeBot and MBot logs, bot_core, Censi, CARMEN.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::import_test {
namespace {

using test::discarded;
using test::list_discarded;
using test::read_text;

// The log as lcm-logger wrote it, against the conversion that was made independently of this program.
TEST(MaebotLog, agrees_with_its_json_lines_conversion) {
  ODOMCALIB_SHARED_FILE(log_path, "maebot/convex.lcmlog.gz");
  ODOMCALIB_SHARED_FILE(jsonl_path, "maebot/convex.jsonl.gz");
  const auto b = value_of(read_recording(jsonl_path));
  const auto a = value_of(read_recording(log_path, &b.robot));
  EXPECT_EQ(discarded(a, "event", "not needed: mbot_lcm_msgs.pose2D_t"), 457U) << list_discarded(a);
  ASSERT_EQ(a.ticks.size(), b.ticks.size());
  for (std::size_t i = 0; i < a.ticks.size(); ++i) {
    EXPECT_NEAR(a.ticks[i].t, b.ticks[i].t, 1e-9);
    EXPECT_EQ(a.ticks[i].left, b.ticks[i].left);
    EXPECT_EQ(a.ticks[i].right, b.ticks[i].right);
  }
  ASSERT_EQ(a.scans.size(), b.scans.size());
  for (std::size_t i = 0; i < a.scans.size(); ++i) {
    ASSERT_EQ(a.scans[i].ranges.size(), b.scans[i].ranges.size());
    EXPECT_NEAR(a.scans[i].t, b.scans[i].t, 1e-9);
    for (std::size_t k = 0; k < a.scans[i].ranges.size(); ++k) {
      // The conversion printed four decimals of ranges, five of angles, six of times.
      EXPECT_NEAR(a.scans[i].ranges[k], b.scans[i].ranges[k], 0.51e-4F);
      EXPECT_NEAR(std::remainder(static_cast<double>(a.scans[i].angles[k] - b.scans[i].angles[k]),
                                 2 * std::numbers::pi),
                  0.0, 0.6e-5);
      EXPECT_NEAR(a.scans[i].times[k], b.scans[i].times[k], 0.6e-6F);
    }
  }
}

TEST(MaebotLog, needs_a_robot_description) {
  ODOMCALIB_SHARED_FILE(path, "maebot/convex.lcmlog.gz");
  const auto result = read_recording(path);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::missing_units);
}

std::string number(std::uint64_t value, std::size_t size) {
  std::string out;
  for (std::size_t i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * (size - 1 - i)));
  return out;
}

std::string real(float value) { return number(std::bit_cast<std::uint32_t>(value), 4); }

std::string event(const std::string& data) {
  return "\xED\xA1\xDA\x01" + std::string(16, '\0') + number(5, 4) + number(data.size(), 4) + "LIDAR" + data;
}

std::string lidar(std::int32_t count, std::int64_t first_stamp) {
  std::string out =
      number(0x89dc5b879a5056cf, 8) + number(5'000'000, 8) + number(static_cast<std::uint32_t>(count), 4);
  for (const float range : {1.0F, 0.04F}) out += real(range);
  for (const float theta : {0.5F, 6.0F}) out += real(theta);
  for (const std::int64_t since : {0, 1000})
    out += number(static_cast<std::uint64_t>(first_stamp + since), 8);
  for (const float intensity : {1.0F, 2.0F}) out += real(intensity);
  return event(out);
}

std::string new_encoders(std::int64_t left) {
  return event(number(0xaefa0bcd9e362081, 8) + number(5'000'000, 8) +
               number(static_cast<std::uint64_t>(left), 8) + number(2, 8) + number(0, 8) +
               std::string(16, '\0'));
}

std::string old_encoder(std::int64_t left) {
  return event(number(0xa8b04e85ffa9d1d1, 8) + number(5'000'000, 8) +
               number(static_cast<std::uint64_t>(left), 8) + number(2, 8) + std::string(4, '\0'));
}

TEST(MbotLog, takes_angles_as_counter_clockwise_unless_the_encoders_are_of_the_older_stack) {
  const auto robot = test::example_robot();
  const auto current = value_of(read_text(new_encoders(-7) + lidar(2, 5'250'000), &robot));
  EXPECT_EQ(current.ticks.at(0).left, -7);
  const auto& scan = current.scans.at(0);
  EXPECT_FLOAT_EQ(scan.angles.at(0), 0.5F);
  EXPECT_NEAR(scan.angles.at(1), 6.0 - 2 * std::numbers::pi, 1e-6);
  EXPECT_EQ(scan.ranges, (std::vector<float>{1.0F, 0.0F})) << "0.05 m and less is no reading";
  EXPECT_EQ(scan.t, 0.25) << "seconds since the whole second of the first message";
  EXPECT_FLOAT_EQ(scan.times.at(1), 0.001F);
  const auto older = value_of(read_text(old_encoder(-7) + lidar(2, 5'250'000), &robot));
  EXPECT_FLOAT_EQ(older.scans.at(0).angles.at(0), -0.5F);
}

TEST(MbotLog, refuses_arrays_that_do_not_fit_their_message) {
  const auto robot = test::example_robot();
  for (const std::int32_t count : {-1, 1, 3, INT32_MAX, INT32_MIN}) {
    const auto result = value_of(read_text(new_encoders(0) + lidar(count, 1), &robot));
    EXPECT_EQ(discarded(result, "scan", "damaged message"), 1U) << count;
  }
}

TEST(BotCoreLog, gives_planar_lidar_scans) {
  std::string data = number(0xe3d17423180b5e8d, 8) + number(1'500'000, 8) + number(2, 4) + real(1) + real(2) +
                     number(0, 4) + real(-1.5F) + real(0.25F);
  const auto robot = test::example_robot();
  const auto result = value_of(read_text(event(data), &robot));
  EXPECT_EQ(result.scans.at(0).angle_min, -1.5);
  EXPECT_EQ(result.scans.at(0).angle_increment, 0.25);
  EXPECT_EQ(result.scans.at(0).ranges, (std::vector<float>{1, 2}));
}

TEST(CensiTuples, are_all_read_where_objects_share_a_line) {
  for (const auto& [name, count, duration] : {std::tuple{"khepera-censi/l90.tuple", 3295U, 2628.0},
                                              {"khepera-censi/lstraight.tuple", 4396U, 3511.0}}) {
    ODOMCALIB_SHARED_FILE(path, name);
    const auto result = value_of(read_recording(path));
    EXPECT_EQ(result.increments.size(), count);
    EXPECT_TRUE(result.discarded.empty()) << list_discarded(result);
    double sum = 0.0;
    for (const auto& increment : result.increments) sum += increment.duration;
    EXPECT_NEAR(sum, duration, 0.5) << "sum of T of the set's description";
    EXPECT_EQ(result.robot.left_wheel_diameter, 0.0) << "wheel angles in rad need no nominal values";
  }
}

TEST(CensiTuples, S3_17_SX_03_take_the_robot_from_the_fallback_and_count_what_is_damaged) {
  const auto robot = test::example_robot();
  const auto r = value_of(read_text(
      R"({ "T": 0.5, "phi_l": 1, "phi_r": -1, "sm": [ 1, 2, 3 ] }{ "T": 1, "phi_l": 1, "phi_r": 1, "sm": [4,5,6] }
{ "T": 1, "phi_l": 1, "phi_r": 1, "sm": [4,5] }
{ "T": 0, "phi_l": 1, "phi_r": 1, "sm": [4,5,6] }
{ "T": 1, "phi_l": null, "phi_r": 1, "sm": [4,5,6] }
{ "T": 1, "phi_l": 1, "phi_r": )"
      "\n"
      R"({ "T": 2, "phi_l": 1, "phi_r": 1, "sm": [4,5,6] }
{ "T": 2, "phi)",
      &robot));
  ASSERT_EQ(r.increments.size(), 3U) << list_discarded(r);
  EXPECT_EQ(r.increments[0].right_speed, -1.0);
  EXPECT_EQ(r.increments[1].lidar_motion[2], 6.0);
  EXPECT_EQ(r.robot.track_width, 0.33);
  EXPECT_EQ(discarded(r, "tuple", "\"sm\" is not three numbers"), 1U);
  EXPECT_EQ(discarded(r, "tuple", "a value is missing or impossible"), 2U);
  EXPECT_EQ(discarded(r, "tuple", "not valid JSON"), 1U);
  EXPECT_EQ(discarded(r, "tuple", "cut off"), 1U);
}

TEST(CensiRawLog, SX_03_gives_scans_and_the_counts_they_carry) {
  ODOMCALIB_SHARED_FILE(path, "mines-rover-2/exp3.scans.jsonl.gz");
  ODOMCALIB_SHARED_FILE(jsonl_path, "mines-rover-2/exp3.jsonl.gz");
  const auto b = value_of(read_recording(jsonl_path));
  const auto a = value_of(read_recording(path, &b.robot));
  ASSERT_EQ(a.scans.size(), b.scans.size());
  ASSERT_EQ(a.ticks.size(), b.ticks.size());
  for (std::size_t i = 0; i < a.scans.size(); ++i) {
    EXPECT_NEAR(a.scans[i].t, b.scans[i].t, 1e-6);
    EXPECT_EQ(a.scans[i].ranges, b.scans[i].ranges);
    EXPECT_NEAR(a.scans[i].angle(681), b.scans[i].angle(681), 1e-5);
    EXPECT_EQ(a.ticks[i].left, b.ticks[i].left);
  }
}

TEST(CensiRawLog, beams_that_it_marks_as_not_valid_are_no_readings) {
  const auto scan = [](double t, const std::string& more) {
    return "{\"type\":\"scan\",\"timestamp\":[" + std::to_string(t) +
           ",0],\"min_theta\":-1,\"max_theta\":1,\"readings\":[1.5,2.5,null,3.5]" + more + "}\n";
  };
  const auto robot = test::example_robot();
  const auto r =
      value_of(read_text(scan(0, "") + scan(1, ",\"nrays\":4,\"valid\":[1,0,0,1]") +
                             scan(2, ",\"valid\":[false,true,false,null]") + scan(3, ",\"valid\":[1,0]") +
                             scan(4, ",\"nrays\":3") + scan(5, ",\"valid\":\"all\""),
                         &robot));
  ASSERT_EQ(r.scans.size(), 4U) << list_discarded(r);
  EXPECT_EQ(r.scans[0].ranges, (std::vector<float>{1.5F, 2.5F, 0, 3.5F}));
  EXPECT_EQ(r.scans[1].ranges, (std::vector<float>{1.5F, 0, 0, 3.5F}));
  EXPECT_EQ(r.scans[2].ranges, (std::vector<float>{0, 2.5F, 0, 0}));
  EXPECT_EQ(discarded(r, "beam", "marked as not valid"), 3U) << list_discarded(r);
  EXPECT_EQ(discarded(r, "scan", "valid does not match ranges"), 1U);
  EXPECT_EQ(discarded(r, "scan", "nrays does not match ranges"), 1U);
  EXPECT_EQ(discarded(r, "value", "valid is no list of numbers"), 1U);
}

// The counts behind this odometry were recovered independently: every one must agree.
TEST(CarmenLog, gives_back_the_counts_behind_its_odometry) {
  ODOMCALIB_SHARED_FILE(path, "azos-wheelchair/laserazosSM3.log");
  ODOMCALIB_SHARED_FILE(counts_path, "azos-wheelchair/ticks_recovered.csv");
  const RobotDescription robot{0.17, 0.17, 0.6, 2000.0, std::nullopt, "", ""};
  const auto r = value_of(read_recording(path, &robot));
  EXPECT_EQ(r.scans.size(), 778U);
  EXPECT_EQ(r.scans[0].ranges.size(), 361U);
  EXPECT_NEAR(r.scans[0].angle(360), std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(discarded(r, "time stamp", "the log has none: 0.2 s per scan assumed"), 778U);
  std::ifstream counts(counts_path);
  std::string line;
  std::getline(counts, line);
  for (const auto& sample : r.ticks) {
    ASSERT_TRUE(std::getline(counts, line));
    const auto comma = line.find(',');
    const auto second = line.find(',', comma + 1);
    EXPECT_EQ(sample.left, std::stoll(line.substr(comma + 1))) << line;
    EXPECT_EQ(sample.right, std::stoll(line.substr(second + 1))) << line;
  }
  EXPECT_EQ(r.ticks.size(), 778U);
  EXPECT_EQ(read_recording(path).error().code, ErrorCode::missing_units);
}

TEST(CarmenLog, SX_03_reads_its_messages_with_their_times_and_the_lidar_pose) {
  const auto robot = test::example_robot();
  const auto r = value_of(read_text(
      "# CARMEN log\nPARAM robot_width 0.5 0 host 0\n"
      "ODOM 0 0 0 0 0 0 1000000000.5 host 0.1\n"
      "ODOM 0.5 0 0 0 0 0 1000000001.5 host 1.1\n"
      "FLASER 3 1 nan 3 1 0.5 0 0.5 0.5 0 1000000001.0 host 0.6\n"
      "ROBOTLASER1 0 -1.5 3.0 1.5 20 0.01 0 3 4 5 21 0 1 0.5 0 0.5 0.5 0 0 0 0 0 0 1000000002.0 host 1.6\n"
      "WHAT 1 2\nFLASER 3 1 2\nODOM 1 x 3\nFLASER 4 1 1",
      &robot));
  ASSERT_EQ(r.scans.size(), 2U) << list_discarded(r);
  EXPECT_EQ(r.scans[0].t, 0.0);
  EXPECT_EQ(r.time_zero, 1000000001.0);
  EXPECT_EQ(r.scans[0].ranges, (std::vector<float>{1, 0, 3}));
  EXPECT_EQ(r.scans[1].ranges, (std::vector<float>{4, 5, 0}));
  EXPECT_EQ(r.scans[1].angle_increment, 1.5);
  ASSERT_EQ(r.ticks.size(), 2U);
  EXPECT_EQ(r.ticks[1].left, std::llround(0.5 / (std::numbers::pi * 0.154) * 2000));
  EXPECT_EQ(r.robot.lidar_pose, (std::array<double, 3>{0.5, 0, 0}));
  EXPECT_EQ(discarded(r, "line", "unknown message"), 1U);
  EXPECT_EQ(discarded(r, "line", "too few or wrong fields"), 2U);
  EXPECT_EQ(discarded(r, "line", "cut off"), 1U);
}

/// A robot that drives 0.1 m a second ahead, with a scan each second.
std::string carmen_scan(int k, const std::string& stamp) {
  const std::string x = std::to_string(0.1 * k);
  return "FLASER 3 1 2 3 " + x + " 0 0 " + x + " 0 0" + stamp;
}

std::string carmen_stamp(int k) { return " " + std::to_string(1000000000 + k) + ".25 host 0.5"; }

// Its messages of both kinds have stamps of their own, milliseconds apart.
TEST(CarmenLog, a_scan_that_is_written_as_both_messages_is_read_once) {
  const auto robot = test::example_robot();
  for (const bool plain_first : {true, false}) {
    std::string log;
    for (int k = 0; k < 10; ++k) {
      const std::string x = std::to_string(0.1 * k), range = std::to_string(3.0 - 0.1 * k);
      const std::string poses = " " + x + " 0 0 " + x + " 0 0", zeros = " 0 0 0 0 0";
      const std::string plain =
          "FLASER 3 1 2 " + range + poses + " " + std::to_string(1000000000 + k) + ".254 host 0.5\n";
      const std::string other = "ROBOTLASER1 0 -1.5 3.0 1.5 20 0.01 0 3 1 2 " + range + " 0" + poses + zeros +
                                " " + std::to_string(1000000000 + k) + ".250 host 0.5\n";
      log += plain_first ? plain + other : other + plain;
    }
    const auto r = value_of(read_text(log, &robot));
    ASSERT_EQ(r.scans.size(), 10U) << list_discarded(r);
    EXPECT_EQ(r.scans[0].angle_increment, 1.5);
    EXPECT_EQ(r.ticks.size(), 10U);
    EXPECT_EQ(discarded(r, "message", "FLASER was not taken: the same scan as a ROBOTLASER1"), 10U)
        << list_discarded(r);
  }
}

TEST(CarmenLog, one_scan_without_a_stamp_leaves_the_stamps_of_the_others) {
  const auto robot = test::example_robot();
  for (const int wrong : {0, 3, 9})
    for (const std::string stamp : {"", " x host y", " 0 host 0"}) {
      std::string log;
      for (int k = 0; k < 10; ++k) log += carmen_scan(k, k == wrong ? stamp : carmen_stamp(k)) + "\n";
      const auto r = value_of(read_text(log, &robot));
      ASSERT_EQ(r.scans.size(), 9U) << wrong << stamp << list_discarded(r);
      EXPECT_NEAR(r.scans.back().t - r.scans.front().t, wrong == 3 ? 9.0 : 8.0, 1e-9);
      EXPECT_EQ(r.time_zero, 1000000000.0 + (wrong == 0 ? 1.0 : 0.0));
      EXPECT_EQ(r.ticks.size(), 9U);
      EXPECT_EQ(discarded(r, "scan", "time stamp missing or impossible"), 1U) << list_discarded(r);
      EXPECT_EQ(discarded(r, "time stamp", "the log has none: 0.2 s per scan assumed"), 0U);
    }
}

TEST(CarmenLog, a_last_line_that_ends_before_its_stamp_is_cut_off) {
  const auto robot = test::example_robot();
  std::string log;
  for (int k = 0; k < 9; ++k) log += carmen_scan(k, carmen_stamp(k)) + "\n";
  auto r = value_of(read_text(log + carmen_scan(9, ""), &robot));
  EXPECT_EQ(r.scans.size(), 9U);
  EXPECT_EQ(r.scans.back().t, 8.25);
  EXPECT_EQ(discarded(r, "line", "cut off"), 1U) << list_discarded(r);
  EXPECT_EQ(r.discarded.size(), 1U) << list_discarded(r);
  r = value_of(read_text("ODOM 0 0 0 0 0 0" + carmen_stamp(0) + "\nODOM 0.8 0 0 0 0 0" + carmen_stamp(8) +
                             "\n" + log + "ODOM 0.9 0 0 0 0 0",
                         &robot));
  EXPECT_EQ(r.ticks.size(), 2U);
  EXPECT_EQ(discarded(r, "line", "cut off"), 1U) << list_discarded(r);
  EXPECT_EQ(r.discarded.size(), 1U) << list_discarded(r);
}

TEST(CarmenLog, without_any_stamp_gets_one_clock_for_all) {
  const auto robot = test::example_robot();
  for (const std::string stamp : {"", " 0 host 0", " 7 host 7"}) {
    std::string log = "ODOM 0 0 0 0 0 0";
    log.append(stamp).append("\nODOM 1 0 0 0 0 0").append(stamp);
    for (int k = 0; k < 10; ++k) log.append("\n").append(carmen_scan(k, stamp));
    const auto r = value_of(read_text(log, &robot));
    ASSERT_EQ(r.scans.size(), 10U) << list_discarded(r);
    EXPECT_NEAR(r.scans.back().t, 1.8, 1e-9);
    EXPECT_EQ(discarded(r, "time stamp", "the log has none: 0.2 s per scan assumed"), 10U);
    EXPECT_EQ(discarded(r, "message", "ODOM was not taken: the scans have no time stamps"), 2U)
        << list_discarded(r);
  }
}

/// It holds odometry, of which the resolution of the encoders need not be known, as of any other.
TEST(CarmenLog, needs_no_resolution_of_the_encoders_and_no_scans) {
  auto robot = test::example_robot();
  robot.ticks_per_rev = 0.0;
  std::string odometry, log;
  for (int k = 0; k < 10; ++k) {
    const std::string x = std::to_string(0.1 * k);
    odometry += "ODOM " + x + " 0 0 0 0 0" + carmen_stamp(k) + "\n";
    log += carmen_scan(k, carmen_stamp(k)) + "\n";
  }
  for (const std::string& text : {log, odometry, odometry + log}) {
    const auto r = value_of(read_text(text, &robot));
    EXPECT_EQ(r.motion, MotionSource::odometry);
    EXPECT_EQ(r.time_zero, 1000000000.0);
    ASSERT_EQ(r.ticks.size(), 10U) << list_discarded(r);
    EXPECT_EQ(r.ticks.back().t, 9.25);
    EXPECT_NEAR(static_cast<double>(r.ticks.back().left) / r.robot.ticks_per_rev,
                0.9 / (std::numbers::pi * 0.154), 1e-5);
  }
  robot.track_width = 0.0;
  EXPECT_EQ(read_text(log, &robot).error().code, ErrorCode::missing_units);
}

TEST(CarmenLog, lines_that_are_not_used_are_told_by_their_names) {
  const auto robot = test::example_robot();
  std::string log = "# of a test\n\nPARAM a b 0 host 0\nODOM 0 0 0 0 0 0" + carmen_stamp(0) + "\n";
  for (int k = 0; k < 3; ++k)
    log +=
        carmen_scan(k, carmen_stamp(k)) + "\nRLASER 1 1 0 0 0 0 0 0 0 host 0\nTRUEPOS 0 0 0 0 0 0 0 host 0\n";
  const auto r = value_of(read_text(log, &robot));
  EXPECT_EQ(discarded(r, "message", "RLASER was not taken"), 3U) << list_discarded(r);
  EXPECT_EQ(discarded(r, "message", "TRUEPOS was not taken"), 3U);
  EXPECT_EQ(discarded(r, "message", "PARAM was not taken"), 1U);
  EXPECT_EQ(discarded(r, "message", "ODOM was not taken: fewer than two have a time stamp"), 1U);
  EXPECT_EQ(r.discarded.size(), 4U) << list_discarded(r);
}

}  // namespace
}  // namespace odomcalib::import_test
