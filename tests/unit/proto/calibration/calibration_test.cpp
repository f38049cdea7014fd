#include "proto/calibration/calibration.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "proto/calibration/value_check.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::calibration_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Calibration example() {
  Calibration c;
  c.robot = {
      0.154,          0.1541, 0.33, 2000.0, std::array<double, 3>{0.1, -0.2, 0.3}, "r1", "canopen:zlac8015d",
      "0xfee/0xd15/7"};
  c.driven = Driven{1.5e9, 1.5e9 + 12.0};
  c.parameters = {{"left_wheel_diameter", {0.1539999999999999, 0.0001, "m"}},
                  {"lidar_yaw", {1e-300, -1.0, "rad"}}};
  c.covariance_order = {"left_wheel_diameter", "lidar_yaw"};
  c.covariance = {{1e-8, -1e-12}, {-1e-12, 0.1 + 0.2}};
  c.linear_correction = LinearCorrection{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9.5}}}, 12.5, {0.1, 0.2, 0.3}};
  c.methods = {{"straight", "only 1 straight run", {}, {}, 0, 0},
               {"joint", std::nullopt, {{"track_width", {0.3, 0.001, "m"}}}, {0.1, 0.2, 0.3}, 10, 3}};
  c.effects = {
      {"time_offset", {{"offset", {-0.155, 0.001, "s"}}}, {1e-9, 0.25, std::nullopt}, {"slip"}, "host"}};
  c.unexplained = Unexplained{{"speed", "load"}, 0.004, 0.3};
  c.residual = {true, std::array<double, 3>{1, 2, 3}, std::array<double, 3>{0.1, 0.2, 0.3}, std::nullopt};
  c.verdict = Verdict::accepted_with_warnings;
  c.reasons = {"line 1\nwith \"quotes\" and ä"};
  c.data = {{"a.jsonl.gz",
             std::string(64, 'a'),
             1.5e9,
             12.5,
             {{"ticks", 100}, {"scans", 20}},
             {{"scan: cut off", 1}},
             {"scan: /scan"},
             Middleware::ros1}};
  c.discarded = {{"interval", "count does not continue", 3, 100, 0.1 + 0.2, 71.0}, {"file", "cut off", 1}};
  c.repairs = {{"times", "of reception", "stamps are in whole seconds"}};
  c.unknown[""] = {{"zz_own", R"({"b":1,"a":[null,true]})"}, {"aa", "\"text\""}};
  return c;
}

// Those of earlier versions state the type of the messages alone, in what was chosen.
TEST(CalibrationFile, says_whose_messages_were_taken) {
  const auto read = [](const char* choice, const char* middleware) {
    auto body = nlohmann::json::parse(to_json(example()));
    body["data"][0]["choices"] = {choice};
    body["data"][0]["middleware"] = middleware == nullptr ? nlohmann::json() : nlohmann::json(middleware);
    return value_of(calibration_from_json(body.dump(), "cal.json")).data[0].middleware;
  };
  EXPECT_EQ(read("scan: /scan (sensor_msgs/msg/LaserScan, 9 messages)", nullptr), Middleware::ros2);
  EXPECT_EQ(read("scan: /scan (sensor_msgs/LaserScan, 9 messages)", nullptr), Middleware::none);
  EXPECT_EQ(read("scan: /scan (sensor_msgs/LaserScan as chosen, 9 messages)", "ros2"), Middleware::ros2);
  EXPECT_EQ(read("scan: /a/msg/b (sensor_msgs/LaserScan, 9 messages)", "ros1"), Middleware::ros1);
  EXPECT_EQ(nlohmann::json::parse(to_json(example()))["data"][0]["middleware"], "ros1");
  Calibration own = example();
  own.data[0].middleware = Middleware::none;
  EXPECT_FALSE(nlohmann::json::parse(to_json(own))["data"][0].contains("middleware"));
}

// A solve of yesterday's recording tomorrow gives the same bytes: the file says when the robot was driven.
TEST(CalibrationFile, says_of_which_robot_it_is_and_when_that_was_driven) {
  const auto told = nlohmann::json::parse(to_json(example()));
  EXPECT_EQ(told["robot"]["robot_id"], "r1");
  EXPECT_EQ(told["driven"]["begin"], "2017-07-14T02:40:00Z");
  EXPECT_EQ(told["driven"]["end"], "2017-07-14T02:40:12Z");
  const auto untold = nlohmann::json::parse(to_json(Calibration{}));
  EXPECT_TRUE(untold["robot"].at("robot_id").is_null());
  EXPECT_TRUE(untold.at("driven").is_null());
}

TEST(CalibrationFile, with_times_that_are_none_is_damaged) {
  for (const char* wrong :
       {"yesterday", "2017-02-30T00:00:00Z", "2017-07-14T02:40:00", "2017-07-14T02:61:00Z",
        "1970-01-01T00:00:10Z", "2017-07-14T02:40:00Z and more"}) {
    auto told = nlohmann::json::parse(to_json(example()));
    told["driven"]["end"] = wrong;
    const auto read = calibration_from_json(told.dump(), "test");
    ASSERT_FALSE(read) << wrong;
    EXPECT_NE(read.error().text().find("\"driven\" is not two times"), std::string::npos)
        << read.error().text();
  }
}

// Equal texts mean equal members: to_json writes all of them, with numbers that read back unchanged.
TEST(CalibrationFile, read_returns_what_was_written) {
  const auto text = to_json(example());
  const auto back = value_of(calibration_from_json(text, "test"));
  EXPECT_EQ(to_json(back), text);
  EXPECT_EQ(back.parameters[0].second.value, 0.1539999999999999);
  EXPECT_EQ(back.covariance, example().covariance);
  EXPECT_EQ(back.unknown, example().unknown);
  EXPECT_EQ(back.robot.lidar_pose, example().robot.lidar_pose);
  EXPECT_EQ(back.robot.controller_id, "0xfee/0xd15/7");
  EXPECT_EQ(back.methods[0].refused, "only 1 straight run");
  EXPECT_EQ(back.data[0].counts, example().data[0].counts);
  EXPECT_EQ(back.data[0].choices, example().data[0].choices);
  EXPECT_EQ(back.data[0].middleware, Middleware::ros1);
  EXPECT_EQ(back.verdict, Verdict::accepted_with_warnings);
  ASSERT_EQ(back.discarded.size(), 2U);
  EXPECT_EQ(back.discarded[0].begin, 0.1 + 0.2);
  EXPECT_EQ(back.discarded[0].of, 100U);
  EXPECT_EQ(back.discarded[1].end, std::nullopt);
  ASSERT_EQ(back.repairs.size(), 1U);
  EXPECT_EQ(back.repairs[0].chosen, "of reception");
}

TEST(CalibrationFile, of_before_is_read_without_what_was_left_out) {
  nlohmann::ordered_json old = nlohmann::ordered_json::parse(to_json(example()));
  old.erase("discarded");
  old.erase("repairs");
  old.erase("recordings");
  old.erase("homogeneity");
  const auto back = value_of(calibration_from_json(old.dump(), "test"));
  EXPECT_TRUE(back.discarded.empty());
  EXPECT_TRUE(back.repairs.empty());
}

TEST(CalibrationFile, has_the_members_of_the_format) {
  const auto json = nlohmann::json::parse(to_json(example()));
  EXPECT_EQ(json["format"], "odomcalib-calibration/1");
  EXPECT_EQ(json["parameters"]["left_wheel_diameter"]["unit"], "m");
  EXPECT_TRUE(json["parameters"]["lidar_yaw"]["std"].is_null()) << "a negative std is no estimate";
  EXPECT_EQ(json["covariance"]["order"][1], "lidar_yaw");
  EXPECT_EQ(json["linear_correction"]["matrix"][2][2], 9.5);
  EXPECT_EQ(json["methods"]["straight"]["refused"], "only 1 straight run");
  EXPECT_EQ(json["methods"]["joint"]["used"], 10);
  EXPECT_EQ(json["effects"][0]["evidence"]["held_out_before"], 0.25);
  EXPECT_TRUE(json["effects"][0]["evidence"]["held_out_after"].is_null());
  EXPECT_EQ(json["unexplained"]["share"], 0.3);
  EXPECT_EQ(json["residual"]["before"]["yaw"], 3);
  EXPECT_TRUE(json["residual"]["noise_floor"].is_null());
  EXPECT_EQ(json["verdict"], "accepted_with_warnings");
  EXPECT_EQ(json["data"][0]["file"], "a.jsonl.gz");
  EXPECT_EQ(json["data"][0]["begin"], 1.5e9);
  EXPECT_EQ(json["zz_own"]["b"], 1);
  EXPECT_TRUE(json["recordings"].is_array());
  EXPECT_TRUE(json.contains("homogeneity") && json["homogeneity"].is_null()) << "of one recording";
}

TEST(CalibrationFile, writes_no_nan_and_no_infinity) {
  auto c = example();
  c.parameters[0].second = {kNan, HUGE_VAL, "m"};
  c.covariance[0][0] = -HUGE_VAL;
  c.linear_correction->condition = HUGE_VAL;
  c.residual.after = std::array<double, 3>{kNan, kNan, kNan};
  c.effects[0].evidence.p_value = kNan;
  const auto text = to_json(c);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
  const auto back = value_of(calibration_from_json(text, "test"));
  EXPECT_TRUE(std::isnan(*back.parameter("left_wheel_diameter")));
  EXPECT_EQ(to_json(back), text);
}

TEST(CalibrationFile, of_an_unfinished_solve_is_refused_and_says_so) {
  const auto back = value_of(calibration_from_json(to_json(Calibration{}), "test"));
  EXPECT_EQ(back.verdict, Verdict::refused);
  EXPECT_EQ(back.reasons.at(0), "solve was not called");
}

TEST(CalibrationFile, rejects_damage_and_names_the_member) {
  const auto broken = [](const char* pointer, const nlohmann::json& value) {
    auto json = nlohmann::json::parse(to_json(example()));
    json[nlohmann::json::json_pointer(pointer)] = value;
    const auto result = calibration_from_json(json.dump(), "cal.json");
    return result.ok() ? std::string("accepted") : result.error().text();
  };
  EXPECT_NE(broken("/parameters/lidar_yaw/value", "1").find("parameters.lidar_yaw.value"), std::string::npos);
  EXPECT_NE(broken("/robot", 3).find("\"robot\""), std::string::npos);
  EXPECT_NE(broken("/verdict", "perhaps").find("\"verdict\""), std::string::npos);
  EXPECT_NE(broken("/parameters/left_wheel_diameter/std", -1.0).find("parameters.left_wheel_diameter.std"),
            std::string::npos);
  EXPECT_EQ(broken("/parameters/left_wheel_diameter/std", nullptr), "accepted") << "not estimated";
  EXPECT_NE(broken("/effects/0/parameters/offset/std", -1e-3).find("offset.std"), std::string::npos);
  EXPECT_NE(broken("/covariance/matrix/0", {1}).find("covariance"), std::string::npos);
  EXPECT_NE(broken("/linear_correction/matrix/0", {1, 2}).find("linear_correction.matrix[0]"),
            std::string::npos);
  EXPECT_NE(broken("/methods/joint/used", -1).find("methods.joint.used"), std::string::npos);
  EXPECT_NE(broken("/format", "odomcalib-calibration/2").find("version"), std::string::npos);
  EXPECT_EQ(broken("/parameters/lidar_yaw/value", 0.5), "accepted");
  EXPECT_EQ(broken("/new_member", 0.5), "accepted") << "changes are additive";
}

TEST(CalibrationFile, names_the_first_value_that_is_no_number) {
  EXPECT_EQ(non_finite_value(example()), std::nullopt);
  auto calibration = example();
  calibration.effects.push_back({"carpet", {{"p_x", {std::nan(""), -1.0, "1"}}}, {}, {}, "host"});
  EXPECT_EQ(non_finite_value(calibration), "effects.carpet.p_x");
  calibration.parameters.front().second.value = INFINITY;
  EXPECT_EQ(non_finite_value(calibration), "parameters." + calibration.parameters.front().first);
}

std::string wrong_value_of(const Calibration& calibration) {
  const auto wrong = wrong_value(calibration, nullptr, "cal.json");
  return wrong ? wrong->text() : "";
}

TEST(WrongValue, is_a_base_parameter_in_another_unit) {
  EXPECT_EQ(wrong_value_of(example()), "");
  for (const auto& [parameter, unit] : {std::pair(0U, "mm"), std::pair(0U, "rad"), std::pair(1U, "deg")}) {
    Calibration calibration = example();
    auto& [name, quantity] = calibration.parameters[parameter];
    quantity.unit = unit;
    const std::string said = wrong_value_of(calibration);
    EXPECT_NE(said.find("cal.json"), std::string::npos) << said;
    EXPECT_NE(said.find("\"parameters." + name + ".unit\""), std::string::npos) << said;
    EXPECT_NE(said.find(parameter == 0 ? "in m," : "in rad,"), std::string::npos) << said;
  }
}

TEST(WrongValue, is_a_base_parameter_beyond_a_robot_unless_the_file_was_refused) {
  for (const auto& [value, is_wrong] :
       {std::pair(9.9, false), std::pair(10.1, true), std::pair(-154.0, true)}) {
    Calibration calibration = example();
    calibration.parameters[0].second.value = value;
    EXPECT_EQ(!wrong_value_of(calibration).empty(), is_wrong) << value;
    calibration.verdict = Verdict::refused;
    EXPECT_EQ(wrong_value_of(calibration), "") << "what a failed fit gave can be looked at";
  }
}

TEST(WrongValue, is_a_parameter_of_an_effect_in_another_unit_than_its_own) {
  const UnitOfEffect seconds = [](const std::string& effect, const std::string& parameter) {
    const bool known = effect == "time_offset" && parameter == "offset";
    return known ? std::optional<std::string>("s") : std::nullopt;
  };
  Calibration calibration = example();
  calibration.effects.push_back({"of_tomorrow", {{"size", {1.0, 0.1, "furlong"}}}, {}, {}, "host"});
  EXPECT_FALSE(wrong_value(calibration, seconds, "cal.json"));
  calibration.effects[0].parameters[0].second.unit = "1";
  EXPECT_FALSE(wrong_value(calibration, seconds, "cal.json")) << "a name that other programs give it";
  calibration.effects[0].parameters[0].second.unit = "ms";
  const auto wrong = wrong_value(calibration, seconds, "cal.json");
  ASSERT_TRUE(wrong);
  EXPECT_NE(wrong->text().find("\"effects.time_offset.parameters.offset.unit\" is \"ms\", not \"s\""),
            std::string::npos)
      << wrong->text();
}

TEST(CalibrationFile, rejects_what_is_no_json_object) {
  for (const std::string text : {"", "{", "[]", "null", "\xff\xfe", "{\"format\":\"other\"}"}) {
    const auto result = calibration_from_json(text, "cal.json");
    ASSERT_FALSE(result.ok()) << text;
    EXPECT_EQ(result.error().code, ErrorCode::format);
  }
  EXPECT_FALSE(calibration_from_json(std::string(100000, '['), "deep").ok());
}

TEST(CalibrationFile, replaces_the_old_file_as_a_whole) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "calibration_replace";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto path = folder / "cal.json";
  ASSERT_TRUE(write_calibration(Calibration{}, path).ok());
  ASSERT_TRUE(write_calibration(example(), path).ok());
  const auto back = value_of(read_calibration(path));
  EXPECT_EQ(to_json(back), to_json(example()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "no temporary file stays";
}

TEST(CalibrationFile, that_cannot_be_written_leaves_an_io_error_and_no_file) {
  const auto result = write_calibration(example(), "/nonexistent/cal.json");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::io);
  EXPECT_EQ(read_calibration("/nonexistent/cal.json").error().code, ErrorCode::io);
}

}  // namespace
}  // namespace odomcalib::calibration_test
