#include "proto/recording/recording.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <random>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::recording_test {
namespace {

using test::discarded;
using test::kRobotLine;
using test::list_discarded;
using test::read_text;

std::string ticks_line(double t, std::int64_t left, std::int64_t right) {
  return R"({"type":"ticks","t":)" + std::to_string(t) + R"(,"left":)" + std::to_string(left) +
         R"(,"right":)" + std::to_string(right) + "}\n";
}

constexpr const char* kScan =
    R"({"type":"scan","t":1,"angle_min":-1,"angle_increment":0.5,"ranges":[1,null,3]})"
    "\n";

ErrorCode code_of(const Result<Recording>& result) {
  return result.ok() ? ErrorCode::usage : result.error().code;
}

TEST(Recording, beams_that_are_sent_from_the_last_to_the_first_are_listed_in_that_order) {
  const std::string ends = R"("range_max":8,"time_increment":-0.25,"ranges":[1,2,3],"intensities":[7,8,9]})";
  const auto r = value_of(read_text(
      std::string(test::kRobotLine) + "\n" + R"({"type":"scan","t":5,"angle_min":1,"angle_increment":-0.5,)" +
      ends + "\n" + R"({"type":"scan","t":6,"angles":[1,0.5,0.25],)" + ends + "\n" +
      R"({"type":"scan","t":7,"angles":[1,0.5,0.25],"times":[0,0.1,0.2],)" + ends));
  ASSERT_EQ(r.scans.size(), 3U) << list_discarded(r);
  for (const std::size_t k : {0U, 1U}) {
    EXPECT_EQ(r.scans[k].t, 4.5 + static_cast<double>(k));
    EXPECT_EQ(r.scans[k].time_increment, 0.25);
    EXPECT_EQ(r.scans[k].ranges, (std::vector<float>{3, 2, 1}));
    EXPECT_EQ(r.scans[k].intensities, (std::vector<float>{9, 8, 7}));
  }
  EXPECT_EQ(r.scans[0].angle_min, 0.0);
  EXPECT_EQ(r.scans[0].angle_increment, 0.5);
  EXPECT_EQ(r.scans[1].angles, (std::vector<float>{0.25F, 0.5F, 1}));
  EXPECT_EQ(r.scans[2].t, 7.0);
  EXPECT_EQ(r.scans[2].ranges, (std::vector<float>{1, 2, 3})) << "times take the place of time_increment";
  EXPECT_EQ(r.discarded.size(), 0U) << list_discarded(r);
}

TEST(Recording, reads_every_kind_of_line) {
  const auto r = value_of(read_text(
      std::string(
          R"({"type":"robot","left_wheel_diameter":0.15,"right_wheel_diameter":0.16,"track_width":0.33,)"
          R"("ticks_per_rev":2796.8,"lidar_pose":[0.1,-0.2,3.1],"robot_id":"r1","controller":"c","controller_id":"e/1/2"})"
          "\n\n") +
      ticks_line(0.5, -3, 4) +
      R"({"type":"scan","t":0.25,"angle_min":1,"angle_increment":-0.5,"time_increment":0.001,"range_min":0.1,)"
      R"("range_max":8,"ranges":[1.5,null,2],"angles":[1,0.4,0],"times":[0,0.002,0.003],"intensities":[9,null,7],)"
      R"("sensor":"front","unknown":{"ranges":[[1]]}})"
      "\r\n" +
      R"({"t":0.1,"x":1,"y":2,"yaw":-3,"type":"pose"})"
      "\n" +
      R"({"type":"gyro","t":0.2,"yaw_rate":-0.25})"));
  EXPECT_EQ(r.discarded.size(), 0U) << list_discarded(r);
  EXPECT_EQ(r.robot.left_wheel_diameter, 0.15);
  EXPECT_EQ(r.robot.right_wheel_diameter, 0.16);
  EXPECT_EQ(r.robot.ticks_per_rev, 2796.8);
  EXPECT_EQ(r.robot.lidar_pose, (std::array<double, 3>{0.1, -0.2, 3.1}));
  EXPECT_EQ(r.robot.robot_id, "r1");
  EXPECT_EQ(r.robot.controller_id, "e/1/2");
  ASSERT_EQ(r.ticks.size(), 1U);
  EXPECT_EQ(r.ticks[0].left, -3);
  ASSERT_EQ(r.scans.size(), 1U);
  const auto& scan = r.scans[0];
  EXPECT_EQ(scan.angle_increment, -0.5);
  EXPECT_EQ(scan.time_increment, 0.001);
  EXPECT_EQ(scan.ranges, (std::vector<float>{1.5F, 0.0F, 2.0F}));
  EXPECT_EQ(scan.angles, (std::vector<float>{1.0F, 0.4F, 0.0F}));
  EXPECT_EQ(scan.times, (std::vector<float>{0.0F, 0.002F, 0.003F}));
  EXPECT_EQ(scan.intensities, (std::vector<float>{9.0F, 0.0F, 7.0F}));
  EXPECT_EQ(scan.sensor, "front");
  ASSERT_EQ(r.poses.size(), 1U);
  EXPECT_EQ(r.poses[0].yaw, -3.0);
  ASSERT_EQ(r.gyro.size(), 1U);
  EXPECT_EQ(r.gyro[0].yaw_rate, -0.25);
}

/// A scan line with one more member.
std::string scan_with(const std::string& member) {
  return R"({"type":"scan","t":1,"angle_min":-1,"angle_increment":0.5,"ranges":[1,null,3],)" + member + "}\n";
}

TEST(Recording, takes_numbers_as_names) {
  const auto r = value_of(read_text(
      R"({"type":"robot","wheel_diameter":0.154,"track_width":0.33,"ticks_per_rev":2000,"robot_id":12,)"
      R"("controller":18446744073709551615,"controller_id":-3})"
      "\n" +
      ticks_line(0, 0, 0) + scan_with(R"("sensor":0)") + scan_with(R"("sensor":1)") +
      scan_with(R"("sensor":1.50)") + scan_with(R"("sensor":null)")));
  ASSERT_EQ(r.scans.size(), 4U) << list_discarded(r);
  EXPECT_EQ(r.scans[0].sensor, "0");
  EXPECT_EQ(r.scans[1].sensor, "1");
  EXPECT_EQ(r.scans[2].sensor, "1.50");
  EXPECT_EQ(r.scans[3].sensor, "");
  EXPECT_EQ(r.robot.robot_id, "12");
  EXPECT_EQ(r.robot.controller, "18446744073709551615");
  EXPECT_EQ(r.robot.controller_id, "-3");
  EXPECT_EQ(r.discarded.size(), 0U) << list_discarded(r);
}

TEST(Recording, counts_values_of_a_wrong_type) {
  for (const auto& [member, reason] : std::vector<std::pair<std::string, std::string>>{
           {R"("sensor":true)", "sensor is no text"},
           {R"("sensor":{"id":0})", "sensor is no text"},
           {R"("sensor":["front"])", "sensor is no text"},
           {R"("angles":"-1 0 1")", "angles is no list of numbers"},
           {R"("theta":{"a":1})", "theta is no list of numbers"},
           {R"("times":0.1)", "times is no list of numbers"},
           {R"("intensities":false)", "intensities is no list of numbers"},
           {R"("range_max":"8")", "range_max is no number"},
           {R"("time_increment":[0.1])", "time_increment is no number"}}) {
    const auto r = value_of(read_text(kRobotLine + ticks_line(0, 0, 0) + scan_with(member)));
    EXPECT_EQ(r.scans.size(), 1U) << member;
    EXPECT_EQ(discarded(r, "value", reason), 1U) << member << ": " << list_discarded(r);
    EXPECT_EQ(r.discarded.size(), 1U) << member << ": " << list_discarded(r);
  }
  const std::string robot =
      R"({"type":"robot","wheel_diameter":0.154,"track_width":0.33,"ticks_per_rev":2000,)";
  for (const auto& [member, what, reason] : std::vector<std::array<std::string, 3>>{
           {R"("robot_id":["r1"])", "value", "robot_id is no text"},
           {R"("controller":false)", "value", "controller is no text"},
           {R"("time_zero":"2024-05-01")", "value", "time_zero is no number"},
           {R"("lidar_pose":{"x":0.1,"y":0,"yaw":0})", "robot", "lidar_pose is not three numbers"},
           {R"("lidar_pose":"0.1 0 0")", "robot", "lidar_pose is not three numbers"},
           {R"("lidar_pose":0.1)", "robot", "lidar_pose is not three numbers"}}) {
    const auto r = value_of(read_text(robot + member + "}\n" + ticks_line(0, 0, 0)));
    EXPECT_EQ(discarded(r, what, reason), 1U) << member << ": " << list_discarded(r);
    EXPECT_EQ(r.discarded.size(), 1U) << member << ": " << list_discarded(r);
  }
}

TEST(Recording, is_told_from_pairs_of_scans_by_the_type_of_the_line_itself) {
  const std::string scan = R"({"type":"scan","t":0,"ranges":[1]})";
  for (const std::string& line :
       {scan, std::string(R"({"t":0,"frame":"a\"}","ranges":[1,{}], "type" : "scan"})"),
        std::string(R"({"type":"scan","t":0,"ranges":[1,)")})
    EXPECT_TRUE(is_recording(line + "\n")) << line;
  for (const std::string& line :
       {std::string(R"({"reference":)").append(scan).append(R"(,"scan":)").append(scan).append("}"),
        std::string(R"({"guess":[0,0,0],"scan":)").append(scan).append("}"),
        std::string(R"({"note":"type","a":["type"],"b":"\"type\":"})"),
        std::string("[").append(scan).append("]")})
    EXPECT_FALSE(is_recording(std::string(line).append("\n").append(scan).append("\n"))) << line;
}

TEST(Recording, notices_a_second_robot_of_the_same_sizes) {
  const std::string robot =
      R"({"type":"robot","wheel_diameter":0.154,"track_width":0.33,"ticks_per_rev":2000)";
  const auto line_with = [&](const std::string& member, const std::string& value) {
    return robot + ",\"" + member + "\":\"" + value + "\"}\n";
  };
  for (const char* member : {"robot_id", "controller", "controller_id"}) {
    const auto line = [&](const std::string& value) { return line_with(member, value); };
    auto r = value_of(read_text(line("a") + ticks_line(0, 0, 0) + line("b") + ticks_line(1, 0, 0)));
    EXPECT_EQ(discarded(r, "robot", "differs from the first robot description"), 1U)
        << member << list_discarded(r);
    r = value_of(read_text(line("a") + ticks_line(0, 0, 0) + line("a") + ticks_line(1, 0, 0)));
    EXPECT_EQ(r.discarded.size(), 0U) << list_discarded(r);
  }
}

TEST(Recording, names_the_missing_or_impossible_unit) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"({"type":"robot","track_width":0.3,"ticks_per_rev":2000})", "wheel_diameter"},
      {R"({"type":"robot","left_wheel_diameter":0.1,"track_width":0.3,"ticks_per_rev":2000})",
       "right_wheel_diameter"},
      {R"({"type":"robot","right_wheel_diameter":0.1,"track_width":0.3,"ticks_per_rev":2000})",
       "left_wheel_diameter"},
      {R"({"type":"robot","wheel_diameter":0.1,"ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":0,"ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":-0.3,"ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":null,"ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":NaN,"ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":"0.3","ticks_per_rev":2000})", "track_width"},
      {R"({"type":"robot","wheel_diameter":0.1,"track_width":0.3})", "ticks_per_rev"},
      {R"({"type":"robot","wheel_diameter":154,"track_width":0.3,"ticks_per_rev":2000})", "wheel_diameter"},
      {"", "wheel_diameter"}};
  for (const auto& [line, field] : cases) {
    const auto result = read_text(line + "\n" + ticks_line(0, 0, 0));
    ASSERT_EQ(code_of(result), ErrorCode::missing_units) << line;
    EXPECT_NE(result.error().what.find("\"" + field + "\""), std::string::npos) << result.error().what;
  }
}

TEST(Recording, says_what_is_wrong_with_a_unit) {
  const auto told = [](const std::string& diameter, const std::string& ticks) {
    const auto result =
        read_text(R"({"type":"robot","wheel_diameter":)" + diameter +
                  R"(,"track_width":0.3,"ticks_per_rev":)" + ticks + "}\n" + ticks_line(0, 0, 0));
    return result.ok() ? "was taken" : result.error().what;
  };
  EXPECT_EQ(told(R"("0.15")", "2000"), "robot description has a \"wheel_diameter\" that is no number");
  EXPECT_EQ(told("NaN", "2000"), "robot description has a \"wheel_diameter\" that is no number");
  EXPECT_EQ(told("null", "2000"), "robot description lacks \"wheel_diameter\", or has 0 for it");
  EXPECT_EQ(told("0.15", "0"), "robot description lacks \"ticks_per_rev\", or has 0 for it");
  EXPECT_NE(told("154", "2000").find("must be at most 10"), std::string::npos);
  EXPECT_EQ(told("0.15", "2000"), "was taken");
}

TEST(Recording, keeps_the_ranges_of_a_scan_whose_intensities_are_of_another_length) {
  const auto r =
      value_of(read_text(kRobotLine + ticks_line(0, 0, 0) +
                         R"({"type":"scan","t":1,"angle_min":0,"angle_increment":0.1,"ranges":[1,2,3],)"
                         R"("intensities":[7,8]}
{"type":"scan","t":2,"angle_min":0,"angle_increment":0.1,"ranges":[1,2,3],"intensities":[7,8,9]}
)"));
  ASSERT_EQ(r.scans.size(), 2U) << list_discarded(r);
  EXPECT_EQ(r.scans[0].ranges.size(), 3U);
  EXPECT_TRUE(r.scans[0].intensities.empty());
  EXPECT_EQ(r.scans[1].intensities.size(), 3U);
  EXPECT_EQ(discarded(r, "value", "intensities do not match ranges"), 1U) << list_discarded(r);
}

TEST(Recording, takes_missing_values_from_the_fallback_and_prefers_its_own) {
  const auto fallback = test::example_robot();
  const auto bare = value_of(read_text(ticks_line(0, 0, 0), &fallback));
  EXPECT_EQ(bare.robot.track_width, 0.33);
  const auto own =
      value_of(read_text(R"({"type":"robot","track_width":0.5})" + ("\n" + ticks_line(0, 0, 0)), &fallback));
  EXPECT_EQ(own.robot.track_width, 0.5);
  EXPECT_EQ(own.robot.left_wheel_diameter, 0.154);
  RobotDescription incomplete;
  incomplete.track_width = 0.3;
  EXPECT_EQ(code_of(read_text(ticks_line(0, 0, 0), &incomplete)), ErrorCode::missing_units);
}

TEST(Recording, tells_empty_files_from_unknown_ones) {
  EXPECT_EQ(code_of(read_text("")), ErrorCode::empty);
  EXPECT_EQ(code_of(read_text(" \n\n")), ErrorCode::empty);
  EXPECT_EQ(code_of(read_text(kRobotLine)), ErrorCode::empty);
  EXPECT_EQ(code_of(read_text("{\"type\":\"other\"}\n")), ErrorCode::empty);
  EXPECT_EQ(code_of(read_text("hello\nworld\n")), ErrorCode::format);
  EXPECT_EQ(code_of(read_text(std::string("\x7f"
                                          "ELF\0\1\2\3",
                                          8))),
            ErrorCode::format);
  EXPECT_EQ(code_of(read_text("VERTEX_SE2 0 0 0 0\n")), ErrorCode::format);
  EXPECT_EQ(code_of(read_recording("/nonexistent/recording.jsonl")), ErrorCode::io);
}

TEST(Recording, uses_what_is_whole_of_a_file_cut_off_at_any_byte) {
  const std::string last = kScan;
  const std::string text = kRobotLine + ticks_line(0, 0, 0) + ticks_line(1, 10, 10) + last;
  for (std::size_t cut = 0; cut <= last.size(); ++cut) {
    const auto result = value_of(read_text(text.substr(0, text.size() - cut)));
    const bool whole = cut <= 1;  // the line end alone is not missed
    EXPECT_EQ(result.ticks.size(), 2U);
    EXPECT_EQ(result.scans.size(), whole ? 1U : 0U) << cut;
    EXPECT_EQ(discarded(result, "line", "cut off"), whole || cut == last.size() ? 0U : 1U) << cut;
  }
}

TEST(Recording, counts_damaged_lines_and_goes_on_behind_them) {
  const auto result = value_of(
      read_text(kRobotLine + ticks_line(0, 0, 0) + "{\"type\":\"ticks\",\"t\":1,\n\x01\x02\n[1]\n12\n" +
                "{\"type\":\"noise\"}\n{}\n" + std::string(5000, '[') + "\n" + ticks_line(1, 10, 10)));
  EXPECT_EQ(result.ticks.size(), 2U);
  EXPECT_EQ(discarded(result, "line", "not valid JSON"), 5U) << list_discarded(result);
  EXPECT_EQ(discarded(result, "line", "unknown type"), 1U);
  EXPECT_EQ(discarded(result, "line", "no type"), 1U);
}

TEST(Recording, rejects_samples_with_missing_or_impossible_values) {
  const auto r = value_of(read_text(std::string(kRobotLine) + ticks_line(0, 0, 0) +
                                    R"({"type":"ticks","left":1,"right":1}
{"type":"ticks","t":1,"left":1}
{"type":"ticks","t":1,"left":1.5,"right":1}
{"type":"ticks","t":1,"left":1e300,"right":1}
{"type":"ticks","t":1,"left":9223372036854775807,"right":1}
{"type":"ticks","t":1,"left":18446744073709551615,"right":1}
{"type":"ticks","t":NaN,"left":1,"right":1}
{"type":"ticks","t":1e300,"left":1,"right":1}
{"type":"pose","t":1,"x":1,"y":null,"yaw":0}
{"type":"gyro","t":1,"yaw_rate":Infinity}
{"type":"scan","t":1,"ranges":[1,2]}
{"type":"scan","t":1,"angle_min":0,"angle_increment":0,"ranges":[1,2]}
{"type":"scan","t":1,"angle_min":0,"angle_increment":0.1,"ranges":[]}
{"type":"scan","t":1,"angles":[0.1],"ranges":[1,2]}
{"type":"scan","t":1,"angles":[0.1,null],"ranges":[1,2]}
{"type":"scan","t":1,"angles":[0.1,0.2],"times":[0],"ranges":[1,2]}
{"type":"scan","t":1,"angles":[0.1,0.2],"times":[0,1e300],"ranges":[1,2]}
)"));
  EXPECT_EQ(r.ticks.size(), 1U);
  EXPECT_EQ(r.scans.size() + r.poses.size() + r.gyro.size(), 0U);
  EXPECT_EQ(discarded(r, "ticks", "time stamp missing or impossible"), 3U) << list_discarded(r);
  EXPECT_EQ(discarded(r, "ticks", "left or right missing or not a whole number"), 4U);
  EXPECT_EQ(discarded(r, "ticks", "count beyond 2^53"), 1U);
  EXPECT_EQ(discarded(r, "pose", "x, y or yaw missing or not a number"), 1U);
  EXPECT_EQ(discarded(r, "gyro", "yaw_rate missing or not a number"), 1U);
  EXPECT_EQ(discarded(r, "scan", "angle_min or angle_increment missing or impossible"), 2U);
  EXPECT_EQ(discarded(r, "scan", "no ranges"), 1U);
  EXPECT_EQ(discarded(r, "scan", "angles do not match ranges"), 1U);
  EXPECT_EQ(discarded(r, "scan", "an angle is not a number"), 1U);
  EXPECT_EQ(discarded(r, "scan", "times do not match ranges"), 1U);
  EXPECT_EQ(discarded(r, "scan", "a beam time is not a number"), 1U);
}

TEST(Recording, turns_beams_that_are_no_distance_into_no_reading) {
  const auto r = value_of(
      read_text(std::string(kRobotLine) +
                R"({"type":"scan","t":0,"angle_min":0,"angle_increment":0.1,"range_min":0.1,"range_max":8.2,)"
                R"("ranges":[0.1,8.2,0.05,8.3,-1,NaN,-Infinity,null,0,"x",[1],1e300,1.0]})"));
  EXPECT_EQ(r.scans.at(0).ranges, (std::vector<float>{0.1F, 8.2F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.0F}));
  EXPECT_EQ(discarded(r, "beam", "outside range_min and range_max"), 3U) << list_discarded(r);
  EXPECT_EQ(discarded(r, "beam", "not a number"), 5U);
}

TEST(Recording, joins_parts_of_a_turn_that_all_carry_its_stamp) {
  std::string text(kRobotLine);
  for (const char* t : {"0", "0.1"})
    for (const char* first : {"0", "1.5707963", "3.1415927", "-1.5707963"})
      text += std::string(R"({"type":"scan","t":)") + t + R"(,"angle_min":)" + first +
              R"(,"angle_increment":0.78539816,"range_max":8,"ranges":[1,2]})" + "\n";
  const auto r = value_of(read_text(text));
  ASSERT_EQ(r.scans.size(), 2U) << list_discarded(r);
  EXPECT_EQ(r.scans[1].ranges.size(), 8U);
  EXPECT_EQ(discarded(r, "scan", "repeated time stamp"), 0U);
  EXPECT_NE(r.choices.at(0).find("6 messages carry the stamp of the one before"), std::string::npos);
}

TEST(Recording, says_what_ranges_look_like_that_all_lie_beyond_the_limits) {
  const auto reason = [](const std::string& ranges) {
    const auto r = value_of(read_text(
        std::string(kRobotLine) +
        R"({"type":"scan","t":0,"angle_min":0,"angle_increment":0.1,"range_min":0.1,"range_max":8.2,)"
        R"("ranges":[)" +
        ranges + "]}"));
    return r.discarded.empty() ? "" : r.discarded[0].reason;
  };
  const std::string outside = "outside range_min and range_max";
  EXPECT_EQ(reason("4000,3500,0,2500"), outside + ": they look like millimetres");
  EXPECT_EQ(reason("400,350,250"), outside + ": they look like centimetres");
  EXPECT_EQ(reason("30,25,9"), outside) << "they may be metres";
  EXPECT_EQ(reason("65535,65535,65535"), outside) << "one value stands for no reading";
  EXPECT_EQ(reason("4000,3500,2"), outside) << "one is within";
  EXPECT_EQ(reason("4000,3500,9e6"), outside) << "no unit brings them all within";
}

TEST(Recording, sorts_what_is_up_to_a_second_late_and_discards_what_is_later) {
  const auto result = value_of(read_text(kRobotLine + ticks_line(2, 20, 20) + ticks_line(1, 10, 10) +
                                         ticks_line(3, 30, 30) + ticks_line(1.99, 19, 19) + kScan));
  ASSERT_EQ(result.ticks.size(), 3U);
  EXPECT_EQ(result.ticks[0].left, 10);
  EXPECT_EQ(result.ticks[2].left, 30);
  EXPECT_EQ(result.scans.size(), 1U) << "each stream has its own order";
  EXPECT_EQ(discarded(result, "ticks", "out of order by more than 1 s"), 1U);
}

TEST(Recording, drops_one_wild_stamp_and_keeps_what_follows_it) {
  const auto result = value_of(read_text(kRobotLine + ticks_line(1, 10, 10) + ticks_line(5000, 20, 20) +
                                         ticks_line(1.1, 30, 30) + ticks_line(1.2, 40, 40)));
  ASSERT_EQ(result.ticks.size(), 3U);
  EXPECT_EQ(result.ticks[1].left, 30);
  EXPECT_EQ(discarded(result, "ticks", "time stamp far ahead of its neighbours"), 1U);
  const auto pause = value_of(
      read_text(kRobotLine + ticks_line(1, 10, 10) + ticks_line(5000, 10, 10) + ticks_line(5000.1, 10, 10)));
  EXPECT_EQ(pause.ticks.size(), 3U) << "a real pause";
}

TEST(Recording, keeps_the_first_of_repeated_stamps) {
  const auto result =
      value_of(read_text(kRobotLine + ticks_line(0, 0, 0) + ticks_line(0, 7, 7) + kScan + kScan));
  ASSERT_EQ(result.ticks.size(), 1U);
  EXPECT_EQ(result.ticks[0].left, 0);
  EXPECT_EQ(result.scans.size(), 1U);
  EXPECT_EQ(discarded(result, "ticks", "repeated time stamp"), 1U);
  EXPECT_EQ(discarded(result, "scan", "repeated time stamp"), 1U);
}

const Discarded& left_out(const Recording& recording, const std::string& what, const std::string& reason) {
  static const Discarded kNothing;
  for (const Discarded& one : recording.discarded)
    if (one.what == what && one.reason == reason) return one;
  return kNothing;
}

TEST(Recording, says_of_how_many_and_when_it_left_samples_out) {
  const auto result =
      value_of(read_text(kRobotLine + ticks_line(0, 0, 0) + ticks_line(1, 10, 10) + ticks_line(1, 10, 10) +
                         ticks_line(2, 20, 20) + ticks_line(2, 21, 20) + ticks_line(4, 40, 40) +
                         ticks_line(1.5, 15, 15) + ticks_line(2.5, 25, 25)));
  const Discarded& repeated = left_out(result, "ticks", kRepeatedStamp);
  EXPECT_EQ(repeated.count, 2U);
  EXPECT_EQ(repeated.of, 8U);
  EXPECT_EQ(repeated.begin, 1.0);
  EXPECT_EQ(repeated.end, 2.0);
  EXPECT_EQ(repeated.copies, 1U) << "one of them was the same sample again";
  const Discarded& late = left_out(result, "ticks", "out of order by more than 1 s");
  EXPECT_EQ(late.count, 2U);
  EXPECT_EQ(late.of, 8U);
  EXPECT_EQ(late.begin, 1.5);
  EXPECT_EQ(late.end, 2.5);
}

TEST(Recording, says_between_which_stamps_the_way_is_not_known) {
  std::string text = kRobotLine;
  for (std::int64_t i = 0; i < 40; ++i)
    text += ticks_line(0.1 * static_cast<double>(i), (i < 20 ? 40 : 9000) + 40 * i, 40 * i);
  const auto result = value_of(read_text(text));
  const Discarded& broken = left_out(result, "ticks", kUncontinued);
  ASSERT_EQ(broken.count, 1U) << list_discarded(result);
  EXPECT_EQ(broken.of, 39U);
  EXPECT_NEAR(broken.begin.value_or(0.0), 1.9, 1e-9);
  EXPECT_NEAR(broken.end.value_or(0.0), 2.0, 1e-9);
}

TEST(Recording, says_when_counts_were_read_wrong) {
  std::string text = kRobotLine;
  for (std::int64_t i = 0; i < 40; ++i)
    text += ticks_line(0.1 * static_cast<double>(i), i == 10 || i == 30 ? 100000 : 40 * i, 40 * i);
  const auto result = value_of(read_text(text));
  const Discarded& misread = left_out(result, "ticks", kMisread);
  ASSERT_EQ(misread.count, 2U) << list_discarded(result);
  EXPECT_EQ(misread.of, 40U);
  EXPECT_NEAR(misread.begin.value_or(0.0), 1.0, 1e-9);
  EXPECT_NEAR(misread.end.value_or(0.0), 3.0, 1e-9);
}

TEST(Recording, reads_gzip_by_content_and_hashes_the_stored_bytes) {
  const std::string text = kRobotLine + ticks_line(0, 1, 2);
  const auto packed = gzip(text).value();
  const auto plain = read_text(text);
  const auto zipped = read_text(packed);
  ASSERT_TRUE(plain.ok() && zipped.ok());
  EXPECT_EQ(zipped.value().ticks.at(0).right, 2);
  EXPECT_EQ(zipped.value().sha256, sha256_hex(packed));
  EXPECT_NE(zipped.value().sha256, plain.value().sha256);
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad")
      << "FIPS 180-2, B.1";
  EXPECT_EQ(zipped.value().name, "odomcalib_Recording.reads_gzip_by_content_and_hashes_the_stored_bytes");
}

TEST(Recording, uses_what_can_be_unpacked_of_a_cut_off_or_damaged_gzip_file) {
  std::string text = kRobotLine;
  for (std::int64_t i = 0; i < 2000; ++i)
    text += ticks_line(static_cast<double>(i) * 0.05, i * i % 977, i * 3);
  auto packed = gzip(text).value();
  const auto cut = value_of(read_text(packed.substr(0, packed.size() / 2)));
  EXPECT_GT(cut.ticks.size(), 100U);
  EXPECT_LT(cut.ticks.size(), 2000U);
  EXPECT_EQ(discarded(cut, "file", "compressed data is cut off"), 1U) << list_discarded(cut);
  for (const Discarded& one : cut.discarded) {
    if (one.what != "file") continue;
    EXPECT_EQ(one.begin, cut.ticks.back().t) << "where the file ends";
  }
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 1);  // check sum
  const auto damaged = value_of(read_text(packed));
  EXPECT_EQ(discarded(damaged, "file", "compressed data is damaged"), 1U);
  const auto two = read_text(gzip(kRobotLine).value() + gzip(ticks_line(0, 0, 0)).value());
  EXPECT_TRUE(two.ok()) << "members that were appended one after the other";
}

TEST(Recording, survives_writing_as_json_lines) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0.0, 10.0);
  Recording r;
  r.robot = {0.1 + 0.05, any(random), any(random), 2796.8, std::array<double, 3>{any(random), 0, -1},
             "ä\"\\",    "c",         "e/1/2"};
  for (int i = 0; i < 50; ++i) {
    const double t = i + any(random) * 0.01;
    r.ticks.push_back({t, std::int64_t{3} * i - 20, std::int64_t{-2} * i, i / 25});
    r.poses.push_back({t, any(random), any(random), any(random)});
    r.gyro.push_back({t, any(random)});
    Scan scan;
    scan.t = t;
    scan.angle_min = any(random);
    scan.angle_increment = -any(random);
    if (i % 2 == 0) scan.time_increment = any(random);
    scan.range_max = 12.0;
    for (int k = 0; k < 100; ++k) {
      scan.ranges.push_back(k % 7 == 0 ? 0.0F : static_cast<float>(any(random)));
      scan.angles.push_back(static_cast<float>(any(random)));
      scan.times.push_back(static_cast<float>((k + 0.09 * any(random)) * 1e-4));  // read in order of time
      scan.intensities.push_back(static_cast<float>(any(random) * 100));
    }
    r.scans.push_back(scan);
  }
  r.time_zero = 1.7e9;
  for (const char* name : {"survives.jsonl", "survives.jsonl.gz"}) {
    const auto path = std::filesystem::path(testing::TempDir()) / name;
    ASSERT_TRUE(write_recording_jsonl(r, path).ok());
    const auto back = read_recording(path);
    ASSERT_TRUE(back.ok()) << back.error().text();
    const auto& b = back.value();
    EXPECT_TRUE(b.discarded.empty()) << list_discarded(b);
    EXPECT_EQ(b.robot.left_wheel_diameter, r.robot.left_wheel_diameter);
    EXPECT_EQ(b.robot.right_wheel_diameter, r.robot.right_wheel_diameter);
    EXPECT_EQ(b.robot.robot_id, r.robot.robot_id);
    EXPECT_EQ(b.robot.controller_id, r.robot.controller_id);
    EXPECT_EQ(b.time_zero, r.time_zero);
    ASSERT_EQ(b.ticks.size(), r.ticks.size());
    ASSERT_EQ(b.scans.size(), r.scans.size());
    for (std::size_t i = 0; i < r.ticks.size(); ++i) {
      EXPECT_EQ(b.ticks[i].t, r.ticks[i].t);
      EXPECT_EQ(b.ticks[i].left, r.ticks[i].left);
      EXPECT_EQ(b.ticks[i].segment, r.ticks[i].segment);
      EXPECT_EQ(b.poses[i].yaw, r.poses[i].yaw);
      EXPECT_EQ(b.gyro[i].yaw_rate, r.gyro[i].yaw_rate);
      EXPECT_EQ(b.scans[i].ranges, r.scans[i].ranges);
      EXPECT_EQ(b.scans[i].angles, r.scans[i].angles);
      EXPECT_EQ(b.scans[i].times, r.scans[i].times);
      EXPECT_EQ(b.scans[i].intensities, r.scans[i].intensities);
      EXPECT_EQ(b.scans[i].angle_increment, r.scans[i].angle_increment);
      EXPECT_EQ(b.scans[i].time_increment, r.scans[i].time_increment);
    }
  }
}

struct RealRecording {
  const char* name;
  std::size_t ticks, scans, poses, first_beams;
};

class RealRecordings : public testing::TestWithParam<RealRecording> {};

TEST_P(RealRecordings, are_read_completely) {
  ODOMCALIB_SHARED_FILE(path, GetParam().name);
  const auto r = value_of(read_recording(path));
  EXPECT_EQ(r.ticks.size(), GetParam().ticks);
  EXPECT_EQ(r.scans.size(), GetParam().scans);
  EXPECT_EQ(r.poses.size(), GetParam().poses);
  EXPECT_EQ(r.scans.empty() ? 0U : r.scans[0].ranges.size(), GetParam().first_beams);
  EXPECT_EQ(r.ticks.back().segment, 0) << "none of these counters was reset";
  EXPECT_TRUE(std::is_sorted(r.ticks.begin(), r.ticks.end(), [](auto& a, auto& b) { return a.t < b.t; }));
  for (const auto& item : r.discarded) EXPECT_TRUE(item.what == "beam" || item.what == "ticks") << item.what;
}

// Counts of lines in the files; brenner-nxt repeats 61 motor samples, the wheelchair writes NaN for "no
// reading".
INSTANTIATE_TEST_SUITE_P(Shared, RealRecordings,
                         testing::Values(RealRecording{"mines-rover/exp1.jsonl.gz", 756, 756, 0, 682},
                                         RealRecording{"mines-rover-2/exp3.jsonl.gz", 525, 525, 0, 682},
                                         RealRecording{"mines-rover-2/test_lab2.jsonl.gz", 404, 404, 0, 682},
                                         RealRecording{"azos-wheelchair/azos.jsonl.gz", 778, 778, 0, 361},
                                         RealRecording{"maebot/a0.jsonl.gz", 1637, 642, 0, 254},
                                         RealRecording{"maebot/convex.jsonl.gz", 3422, 459, 0, 295},
                                         RealRecording{"maebot/empty.jsonl.gz", 1506, 403, 0, 290},
                                         RealRecording{"brenner-nxt/robot4.jsonl.gz", 217, 278, 0, 660},
                                         RealRecording{"optiodom-rawclock/square-230620202042-01.jsonl.gz",
                                                       1814, 0, 9383, 0}));

TEST(Recording, of_motion_capture_runs_are_all_read) {
  ODOMCALIB_SHARED_FILE(folder, "optiodom");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".gz") continue;
    ++files;
    const auto result = value_of(read_recording(entry.path()));
    EXPECT_TRUE(result.discarded.empty()) << entry.path() << list_discarded(result);
    EXPECT_EQ(result.ticks.back().segment, 0) << entry.path();
    EXPECT_GT(result.poses.size(), 10U);
  }
  EXPECT_EQ(files, 102U);
}

TEST(Recording, of_five_minutes_loads_within_the_time_budget) {
  std::string text = kRobotLine;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> range(0.1, 20.0);
  std::string ranges;
  for (int k = 0; k < 1081; ++k) ranges += (k > 0 ? "," : "") + std::to_string(range(random)).substr(0, 6);
  for (int i = 0; i < 15000; ++i) {
    text += ticks_line(i * 0.02, std::int64_t{10} * i, std::int64_t{10} * i);
    if (i % 5 == 0)
      text += R"({"type":"scan","t":)" + std::to_string(i * 0.02) +
              R"(,"angle_min":-2.35,"angle_increment":0.00436,"range_max":30,"ranges":[)" + ranges + "]}\n";
  }
  const auto path = test::write_file("five_minutes.jsonl", text);
  const auto start = std::clock();
  const auto result = read_recording(path);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::filesystem::remove(path);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().scans.size(), 3000U);
  RecordProperty("cpu_seconds", std::to_string(seconds));
#if !defined(ODOMCALIB_SANITIZED)
  EXPECT_LT(seconds, 3.0) << "usually about 1 s of processor time; the limit allows for a busy machine";
#endif
}

/// Lines that cross the borders of whatever pieces a file is read in.
std::string long_text(std::size_t lines) {
  std::string text = kRobotLine;
  for (std::size_t i = 0; i < lines; ++i)
    text +=
        i % 97 == 5 ? std::string("{damaged\n") : ticks_line(0.02 * static_cast<double>(i), 1, 2) + "\r\n";
  return text + R"({"type":"ticks","t":)";
}

TEST(Recording, of_a_long_file_is_the_same_in_whatever_pieces_it_comes) {
  const std::string text = long_text(60000);
  ASSERT_GT(text.size(), 3U << 20U) << "more than what tells the form";
  const auto path = test::write_file("long.jsonl", text);
  const auto packed = test::write_file("long.jsonl.gz", gzip(text).value());
  const Recording whole = value_of(read_recording_bytes(text, path));
  for (const auto& file : {path, packed}) {
    const Recording in_pieces = value_of(read_recording(file));
    EXPECT_EQ(in_pieces.ticks.size(), whole.ticks.size());
    EXPECT_EQ(in_pieces.ticks.back().t, whole.ticks.back().t);
    EXPECT_EQ(list_discarded(in_pieces), list_discarded(whole));
    EXPECT_EQ(in_pieces.sha256, sha256_hex(read_file_bytes(file).value()));
    std::filesystem::remove(file);
  }
  EXPECT_EQ(whole.ticks.size(), 60000U - 619U);
  EXPECT_EQ(discarded(whole, "line", "not valid JSON"), 619U);
  EXPECT_EQ(discarded(whole, "line", "cut off"), 1U);
}

TEST(Recording, in_lines_may_be_longer_than_what_has_to_be_kept) {
  const UnpackLimit limit{std::size_t{2} << 20};
  const std::string text = long_text(60000);
  ASSERT_GT(text.size(), limit.most);
  const std::string lines = gzip(text).value(), other = gzip(std::string(text.size(), 'x')).value();
  EXPECT_EQ(value_of(read_recording_bytes(lines, "long.jsonl.gz", nullptr, {}, limit)).ticks.size(),
            60000U - 619U);
  const auto refused = read_recording_bytes(other, "other.gz", nullptr, {}, limit);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().what, "unpacks to more than 2 MiB");
  const auto unwanted =
      read_recording_bytes(lines, "long.jsonl.gz", nullptr, {}, UnpackLimit::allowed(limit.most));
  ASSERT_FALSE(unwanted.ok()) << "who states a limit means it";
  EXPECT_EQ(unwanted.error().what, "unpacks to more than 2 MiB");
}

/// Largest memory of this process so far, MiB.
long peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST(Recording, takes_no_memory_for_its_text) {
#if defined(ODOMCALIB_SANITIZED)
  GTEST_SKIP() << "sanitizers keep what was freed";
#endif
  const auto plain = test::write_file("much_text.jsonl", long_text(1000).substr(0, 50000));
  std::ofstream text(plain, std::ios::app);
  for (int i = 0; i < 1 << 16; ++i) text << '\n' << std::string(999, ' ');
  text.close();
  const auto packed = test::write_file("much_text.jsonl.gz", gzip(read_file_bytes(plain).value()).value());
  // Memory that this test has used itself is free again, and would hide what reading takes.
  const auto peak_of = [](const std::filesystem::path& file) {
    const pid_t child = fork();
    if (child == 0) {
      const long before = peak_memory();
      const bool read = read_recording(file, nullptr, {}, UnpackLimit::allowed(std::size_t{1} << 30)).ok();
      _exit(read ? static_cast<int>(std::min(peak_memory() - before, 200L)) : 255);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WEXITSTATUS(status);
  };
  EXPECT_LT(peak_of(plain), 10) << "MiB, of 62 MiB of text";
  EXPECT_LT(peak_of(packed), 10) << "MiB";
  std::filesystem::remove(plain);
  std::filesystem::remove(packed);
}

TEST(Recording, keeps_no_intensities_where_nobody_wants_them) {
  const auto path = test::write_file(
      "bright.jsonl",
      std::string(kRobotLine) +
          R"({"type":"scan","t":1,"angle_min":-1,"angle_increment":0.5,"ranges":[1,2],"intensities":[3,4]})"
          "\n");
  const Recording all = value_of(read_recording(path));
  const Recording spare = value_of(read_recording(path, nullptr, {}, {}, Intensities::left_out));
  std::filesystem::remove(path);
  EXPECT_EQ(all.scans.front().intensities, (std::vector<float>{3.0F, 4.0F}));
  EXPECT_EQ(spare.scans.front().intensities.capacity(), 0U);
  EXPECT_EQ(spare.scans.front().ranges, all.scans.front().ranges);
}

}  // namespace
}  // namespace odomcalib::recording_test
