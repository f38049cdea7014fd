#include "daemon/cli/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "daemon/cli/comparison_document.hpp"
#include "proto/calibration/utc.hpp"
#include "tests/unit/calib/comparison/calibrations.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::comparison_test {
namespace {

using test_support::TrueState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kFirstDay = 1767348000.0;  // 2026-01-02, 10:00 UTC
constexpr double kMonth_s = 30.0 * 86'400.0;

/// A calibration of a robot with a recording of its own.
ComparedFile file(const std::string& name, const std::string& robot, std::optional<int> month,
                  std::mt19937& random, const TrueState& state = {}) {
  ComparedFile made{"/data/" + name + ".json", test_support::drawn(state, random)};
  made.calibration.robot.robot_id = robot;
  made.calibration.data = {{name, std::string(62, '0') + name, std::nullopt, 300.0, {}, {}, {}}};
  if (month) {
    const double begin = kFirstDay + *month * kMonth_s;
    made.calibration.driven = Driven{begin, begin + 300.0};
  }
  return made;
}

/// Twelve calibrations, one a month and 5 km, of tyres that lose 30 um of diameter a km.
std::vector<ComparedFile> year(std::mt19937& random) {
  std::vector<ComparedFile> files;
  for (int month = 0; month < 12; ++month) {
    TrueState worn;
    worn.left -= 30e-6 * 5.0 * month;
    worn.right -= 30e-6 * 5.0 * month;
    files.push_back(file("m" + std::to_string(10 + month), "r1", month, random, worn));
    files.back().calibration.scale = {1.0, 0.01, "lidar data sheet"};
    files.back().calibration.odometer = 5000.0 * month;
  }
  return files;
}

std::string text(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options,
                 Extent extent = Extent::steps, std::size_t width = kAnyWidth) {
  return to_text(describe(robots, options, extent), true, width);
}

std::vector<std::string> names(const ComparedRobot& robot) {
  std::vector<std::string> all;
  for (const ComparedFile& one : robot.files) all.push_back(file_name(one.path));
  return all;
}

TEST(Compare, goes_in_order_of_dates_or_as_named_and_says_which) {
  std::mt19937 random(1);
  const auto dated = value_of(compare({file("b", "r1", 2, random), file("a", "r1", 1, random)}, {}));
  EXPECT_THAT(names(dated.front()), ElementsAre("a.json", "b.json"));
  EXPECT_THAT(text(dated, {}), HasSubstr("in order of the dates"));
  const auto named = value_of(compare({file("b", "r1", 2, random), file("a", "r1", {}, random)}, {}));
  EXPECT_THAT(names(named.front()), ElementsAre("b.json", "a.json"));
  EXPECT_THAT(text(named, {}), HasSubstr("not every recording tells its date"));
}

TEST(Compare, refuses_two_robots_unless_by_robot) {
  std::mt19937 random(2);
  const auto two = [&] {
    return std::vector<ComparedFile>{file("a", "r1", 1, random), file("b", "r1", 2, random),
                                     file("c", "r2", 1, random)};
  };
  const auto refused = compare(two(), {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().text(), HasSubstr("--by robot"));
  EXPECT_EQ(value_of(compare(two(), {.by_robot = true, .trend = false, .bound = std::nullopt})).size(), 2U);
}

TEST(Compare, takes_a_file_without_a_name_for_the_only_robot_there_is) {
  std::mt19937 random(3);
  EXPECT_TRUE(compare({file("a", "r1", 1, random), file("b", "", 2, random)}, {}));
  EXPECT_TRUE(compare({file("a", "", 1, random), file("b", "", 2, random)}, {}));
  const auto many = value_of(compare({file("a", "r1", 1, random), file("b", "r2", 1, random),
                                      file("c", "", 1, random), file("d", "", 1, random)},
                                     {.by_robot = true, .trend = false, .bound = std::nullopt}));
  EXPECT_EQ(many.size(), 4U) << "of several nobody knows of which it is";
}

TEST(Compare, of_a_fleet_leaves_each_file_without_a_name_alone_and_says_how_to_name_it) {
  std::mt19937 random(15);
  const ComparisonOptions fleet{true, false, std::nullopt};
  const auto one_named = value_of(
      compare({file("a", "r1", 1, random), file("b", "", 2, random), file("c", "", 3, random)}, fleet));
  ASSERT_EQ(one_named.size(), 3U) << "none is taken to be of r1";
  const std::string told = text(one_named, fleet, Extent::summary);
  EXPECT_THAT(told, HasSubstr("1 robot and 2 files that name no robot, 3 fine"));
  EXPECT_THAT(told, HasSubstr("b.json, c.json name no robot (robot_id)"));
  EXPECT_THAT(told, HasSubstr("solve RECORDING --robot-id NAME"));
  EXPECT_THAT(text(one_named, fleet), HasSubstr("robot without a name (b.json): nothing to compare"));
  const auto unnamed = value_of(compare({file("a", "", 1, random), file("b", "", 2, random)}, fleet));
  ASSERT_EQ(unnamed.size(), 2U) << "nor are they one robot";
  EXPECT_THAT(text(unnamed, fleet, Extent::summary), HasSubstr("2 files that name no robot, 2 fine"));
}

TEST(Compare, tells_drives_of_one_day_apart_by_time_or_by_name) {
  std::mt19937 random(16);
  auto files = std::vector<ComparedFile>{file("a", "r1", 0, random), file("b", "r1", 0, random),
                                         file("c", "r1", 1, random)};
  files[0].calibration.driven = Driven{kFirstDay + 4000.0, kFirstDay + 4300.0};
  const std::string told = text(value_of(compare({files[0], files[1]}, {})), {});
  EXPECT_THAT(told, HasSubstr("From 2026-01-02 10:00 to 2026-01-02 11:06"));
  EXPECT_THAT(told, HasSubstr("a.json  2026-01-02 11:06"));
  EXPECT_THAT(text(value_of(compare({files[1], files[2]}, {})), {}),
              HasSubstr("From 2026-01-02 to 2026-02-01"));
  files[0].calibration.driven = Driven{kFirstDay + 5.0, kFirstDay + 300.0};
  EXPECT_THAT(text(value_of(compare({files[0], files[1]}, {})), {}),
              HasSubstr("From 2026-01-02 10:00 (b.json) to 2026-01-02 10:00 (a.json)"));
}

TEST(Compare, leaves_out_what_was_refused_and_what_is_of_the_same_recording) {
  std::mt19937 random(4);
  auto files = std::vector<ComparedFile>{file("a", "r1", 1, random), file("b", "r1", 2, random),
                                         file("c", "r1", 3, random), file("d", "r1", 4, random)};
  files[1].calibration.verdict = Verdict::refused;
  files[2].calibration.data.push_back(files[0].calibration.data.front());
  const auto robots = value_of(compare(files, {}));
  EXPECT_EQ(robots.front().usable, (std::vector<std::size_t>{2, 3}));
  EXPECT_THAT(text(robots, {}), HasSubstr("left out: same recording as c.json"));
  EXPECT_THAT(text(robots, {}), HasSubstr("left out: refused"));
  const auto alone = compare({files[0], files[2]}, {});
  ASSERT_FALSE(alone);
  EXPECT_THAT(alone.error().text(), HasSubstr("no proof of itself"));
  const auto refused = compare({files[0], files[1]}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_EQ(compare({files[0]}, {}).error().code, ErrorCode::usage);
}

TEST(Compare, says_in_words_what_changed_and_that_the_metre_cancels) {
  std::mt19937 random(5);
  TrueState moved;
  moved.x += 0.01;
  auto files = std::vector<ComparedFile>{file("a", "r1", 0, random), file("b", "r1", 1, random, moved)};
  for (ComparedFile& one : files) one.calibration.scale = {1.0, 0.01, "lidar data sheet"};
  files[1].calibration.effects = {{"backlash", {}, {}, {}, "host"}};
  const std::string told = text(value_of(compare(files, {})), {});
  EXPECT_THAT(told, HasSubstr("robot r1: something changed (p < 0.0001)"));
  EXPECT_THAT(told, HasSubstr("From 2026-01-02 to 2026-02-01"));
  EXPECT_THAT(told, HasSubstr("changed: lidar x;"));
  EXPECT_THAT(told, HasSubstr("its error cancels in differences"));
  EXPECT_THAT(told, HasSubstr("effects that came: backlash"));
  files[1].calibration.scale = {1.002, 0.001, "stated"};
  EXPECT_THAT(text(value_of(compare(files, {})), {}), HasSubstr("metres of the references are not the same"));
  files[0].calibration.robot.ticks_per_rev = 8192.0;
  files[1].calibration.robot.ticks_per_rev = 4096.0;
  EXPECT_THAT(text(value_of(compare(files, {})), {}), HasSubstr("different ticks_per_rev"));
  EXPECT_THAT(text(value_of(compare({file("a", "", 0, random), file("b", "", 1, random)}, {})), {}),
              HasSubstr("robot without a name: nothing changed"));
}

TEST(Compare, says_which_effect_came_and_that_lengths_did_not_change) {
  std::mt19937 random(13);
  auto files = std::vector<ComparedFile>{file("a", "r1", 0, random), file("b", "r1", 1, random)};
  files[1].calibration.effects = {{"backlash", {{"left_play", {0.06, 1e-4, "rad"}}}, {}, {}, "host"}};
  const std::string unknown = text(value_of(compare(files, {})), {});
  EXPECT_THAT(unknown, HasSubstr("robot r1: nothing changed (p "));
  EXPECT_THAT(unknown, HasSubstr("), but effects are in one only: backlash\n"));
  EXPECT_THAT(unknown, HasSubstr("changed: nothing; in one only: backlash;"));
  files[0].calibration.detectable = {{"backlash", "left_play", "rad", 0.003, 0.02, ""}};
  const auto robots = value_of(compare(files, {}));
  const std::string told = text(robots, {});
  EXPECT_THAT(told, HasSubstr("robot r1: something changed: backlash came; nothing else did (p "));
  EXPECT_THAT(told, HasSubstr("changed: backlash came; joint test"));
  EXPECT_THAT(told, HasSubstr("backlash (left play 3.44 deg; the other drives would have shown 0.172 deg)"));
  EXPECT_THAT(told, HasSubstr("this holds for the lengths alone"));
  const auto step = to_json(robots, {})["robots"][0]["steps"][0];
  EXPECT_TRUE(step["changed"].get<bool>());
  EXPECT_EQ(step["came"], nlohmann::ordered_json({"backlash"}));
  EXPECT_TRUE(step["in_one_only"][0]["changed"].get<bool>());
  EXPECT_EQ(to_json(robots, {})["robots"][0]["state"], "changed");
  EXPECT_THAT(to_csv(robots), HasSubstr("accepted,backlash: left_play,rad,0.06,0.0001,,,"));
  const ComparisonOptions fleet{true, false, std::nullopt};
  EXPECT_THAT(text(value_of(compare(files, fleet)), fleet, Extent::summary), HasSubstr("backlash came"));
}

TEST(Compare, names_the_value_of_an_effect_that_changed) {
  std::mt19937 random(14);
  auto files = std::vector<ComparedFile>{file("a", "r1", 0, random), file("b", "r1", 1, random),
                                         file("c", "r1", 2, random)};
  for (std::size_t k = 0; k < 3; ++k)
    files[k].calibration.effects = {
        {"backlash", {{"left_play", {k < 2 ? 0.06 : 0.03, 1e-4, "rad"}}}, {}, {}, "host"}};
  const auto robots = value_of(compare(files, {}));
  EXPECT_THAT(text(robots, {}), HasSubstr("something changed: backlash: left play; nothing else did"));
  EXPECT_FALSE(robots.front().steps[0].is_change());
  EXPECT_TRUE(robots.front().steps[1].is_change());
  EXPECT_THAT(to_csv(robots), HasSubstr("backlash: left_play,rad,0.03,0.0001,-0.03,0.000141"));
}

// The bound is of 5 mm in a metre of a diameter of some 148.5 mm, at 150 um a month: five months ahead.
TEST(Compare, finds_the_wear_of_a_year_and_the_date_of_a_bound) {
  std::mt19937 random(6);
  const ComparisonOptions options{false, true, 0.005};
  const auto robots = value_of(compare(year(random), options));
  const auto told = to_json(robots, options);
  const auto& trends = told["robots"][0]["trends"];
  ASSERT_EQ(trends.size(), 2U);
  EXPECT_EQ(trends[0]["over"], "date");
  EXPECT_EQ(trends[1]["over"], "distance");
  const auto& wear = trends[1]["parameters"]["mean_wheel_diameter"];
  EXPECT_NEAR(wear["slope"].get<double>(), -30e-9, 2.0 * wear["std"].get<double>()) << "30 um a km";
  EXPECT_LT(wear["std"].get<double>(), 1e-9);
  EXPECT_TRUE(wear["significant"].get<bool>());
  EXPECT_FALSE(trends[1]["parameters"]["track_width"]["significant"].get<bool>());
  const auto& passes = trends[0]["passes"];
  EXPECT_LT(passes["earliest"].get<std::string>(), passes["at"].get<std::string>());
  EXPECT_LT(passes["at"].get<std::string>(), passes["latest"].get<std::string>());
  EXPECT_NEAR((utc_from(passes["at"]).value() - kFirstDay) / kMonth_s, 11.0 + 5.0, 0.5);
  const std::string all = text(robots, options);
  EXPECT_THAT(all, HasSubstr("a metre by the newest values is off by 5 mm/m at 2027-0"));
  EXPECT_THAT(all, HasSubstr("um/km"));
  EXPECT_THAT(all, HasSubstr("um/day"));
  EXPECT_THAT(text(robots, {}), Not(HasSubstr("um/day"))) << "not asked for";
}

TEST(Compare, of_a_robot_that_does_not_wear_tells_an_earliest_date_alone) {
  std::mt19937 random(7);
  std::vector<ComparedFile> files;
  files.reserve(6);
  for (int month = 0; month < 6; ++month) files.push_back(file(std::to_string(month), "r1", month, random));
  const ComparisonOptions options{false, true, 0.005};
  const auto robots = value_of(compare(files, options));
  EXPECT_THAT(text(robots, options), HasSubstr("the slope may be none"));
  EXPECT_TRUE(to_json(robots, options)["robots"][0]["trends"][0]["passes"]["at"].is_null());
}

TEST(Compare, makes_a_table_of_a_fleet_the_most_urgent_first) {
  std::mt19937 random(8);
  TrueState worn;
  worn.left *= 0.99;
  auto files = std::vector<ComparedFile>{file("a", "fine", 0, random), file("b", "fine", 1, random),
                                         file("c", "worn", 0, random), file("d", "worn", 1, random, worn),
                                         file("e", "unknown", 0, random)};
  files[4].calibration.verdict = Verdict::refused;
  const ComparisonOptions options{true, false, std::nullopt};
  const auto robots = value_of(compare(files, options));
  ASSERT_EQ(robots.size(), 3U);
  EXPECT_EQ(robots[0].robot_id, "unknown");
  EXPECT_EQ(robots[1].robot_id, "worn");
  EXPECT_EQ(robots[2].robot_id, "fine");
  const std::string told = text(robots, options, Extent::summary);
  EXPECT_THAT(told, HasSubstr("3 robots, 1 refused, 1 changed, 1 fine"));
  EXPECT_THAT(told, HasSubstr("left wheel diameter"));
}

TEST(Compare, has_the_date_of_the_bound_in_the_table_of_a_fleet) {
  std::mt19937 random(12);
  auto files = year(random);
  files.push_back(file("x", "r2", 0, random));
  const ComparisonOptions options{true, true, 0.005};
  const std::string told = text(value_of(compare(files, options)), options, Extent::summary);
  EXPECT_THAT(told, HasSubstr("passes 5 mm/m"));
  EXPECT_THAT(told.substr(0, told.find("robot r1: ")), HasSubstr("  2027-0"));
}

TEST(Compare, fits_a_terminal_of_eighty_columns) {
  std::mt19937 random(9);
  auto files = year(random);
  files[3].calibration.effects = {{"direction_dependent_diameter", {}, {}, {}, "host"}};
  for (const bool by_robot : {false, true}) {
    const ComparisonOptions options{by_robot, true, 0.005};
    std::istringstream lines(text(value_of(compare(files, options)), options, Extent::steps, 80));
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
  }
}

TEST(Compare, draws_a_picture_of_each_parameter_with_its_line) {
  std::mt19937 random(10);
  const ComparisonOptions options{false, true, std::nullopt};
  const std::string page = page_of(describe(value_of(compare(year(random), options)), options, Extent::page));
  std::size_t pictures = 0;
  for (std::size_t at = page.find("<figure>"); at != std::string::npos; at = page.find("<figure>", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 14U) << "six parameters and the mean diameter, over date and over distance";
  EXPECT_THAT(page, HasSubstr("days since 2026-01-02"));
  EXPECT_THAT(page, HasSubstr("weighted line"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  const std::string plain = page_of(describe(value_of(compare(year(random), {})), {}, Extent::page));
  EXPECT_THAT(plain, Not(HasSubstr("weighted line")));
  EXPECT_THAT(plain, HasSubstr("<figure>"));
}

TEST(Compare, writes_a_line_a_value_with_its_change) {
  std::mt19937 random(11);
  auto files = std::vector<ComparedFile>{file("a", "r,1", 0, random), file("b", "r,1", 1, random)};
  std::istringstream lines(to_csv(value_of(compare(files, {}))));
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  ASSERT_EQ(all.size(), 13U) << "a head and six of each";
  EXPECT_THAT(all[1],
              HasSubstr(R"("r,1",/data/a.json,2026-01-02T10:00:00Z,,accepted,left_wheel_diameter,m,0.1)"));
  EXPECT_TRUE(all[1].ends_with(",,,")) << all[1];
  EXPECT_FALSE(all[7].ends_with(",")) << all[7];
}

TEST(ErrorOfMetre, is_read_in_mm_in_a_metre_or_per_cent) {
  EXPECT_DOUBLE_EQ(value_of(error_of_metre_from_text("5mm/m")), 0.005);
  EXPECT_DOUBLE_EQ(value_of(error_of_metre_from_text("0.5%")), 0.005);
  for (const char* wrong :
       {"", "5", "5mm", "mm/m", "-5mm/m", "0%", "nan%", "inf%", "21%", "5 mm/m", "5,0mm/m"})
    EXPECT_FALSE(error_of_metre_from_text(wrong)) << wrong;
}

}  // namespace
}  // namespace odomcalib::cli::comparison_test
