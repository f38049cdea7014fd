// Problems that people reported of other programs, made small: each case gives its right value. The files are
// not part of the repository; what they show is repeated with small inputs in the tests beside this one.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/decode/decode.hpp"
#include "tests/unit/drivers/decoded.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::cases_test {
namespace {

using nlohmann::json;
using test::named;
using test::of_type;

// NOLINTBEGIN(bugprone-macro-parentheses): a declaration takes none
#define SKIP_WITHOUT_CASES(folder)   \
  const auto folder = test::cases(); \
  if (folder.empty()) GTEST_SKIP() << "no cases: set ODOMCALIB_SHARED to the folder that holds cases/"
// NOLINTEND(bugprone-macro-parentheses)

std::vector<json> decoded(const std::string& driver, const std::filesystem::path& file) {
  auto lines = test::lines_of(decode(driver, test::read_text(file), test::kProfiles, file.string()));
  if (lines.empty()) lines.push_back(json::object());
  return lines;
}

/// Ranges are rounded to millimetres or quarters of them, angles to 1/64 degree: 3 mm at 2.8 m.
void expect_square_room(const json& scan, const std::string& model) {
  for (std::size_t i = 0; i < scan["ranges"].size(); ++i) {
    ASSERT_TRUE(scan["ranges"][i].is_number()) << model;
    const double range = scan["ranges"][i], angle = scan["angles"][i];
    EXPECT_GE(range, 1.999) << model;
    EXPECT_LE(range, 2.830) << model;
    EXPECT_NEAR(range * std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle))), 2.0, 0.006)
        << model << " at " << angle;
  }
}

TEST(Cases, every_ydlidar_model_sees_the_room_where_it_is) {
  SKIP_WITHOUT_CASES(folder);
  for (const std::string model : {"g2", "g4", "g6", "g7", "tg30"}) {
    const auto lines = decoded("ydlidar:" + model, folder / "ydlidar-models" / (model + ".txt"));
    const auto scans = of_type(lines, "scan");
    ASSERT_GE(scans.size(), 2U) << model;
    for (const json& scan : scans) expect_square_room(scan, model);
    EXPECT_EQ(lines.back()["skipped"], 0) << model;
  }
}

TEST(Cases, bytes_of_a_coin_d4_are_its_ranges_and_the_wrong_model_is_told_with_the_one_that_fits) {
  SKIP_WITHOUT_CASES(folder);
  const auto file = folder / "coin-d4/coind4.txt";
  const auto lines = decoded("ydlidar:coin-d4", file);
  const auto scans = of_type(lines, "scan");
  ASSERT_FALSE(scans.empty());
  const std::vector<double> expected = {0.0, 0.650, 0.661, 0.675};
  for (std::size_t i = 1; i < expected.size(); ++i)
    EXPECT_NEAR(scans[0]["ranges"][i].get<double>(), expected[i], 1e-6) << scans[0]["ranges"].dump();
  const json& angles = scans[0]["angles"];
  for (std::size_t i = 2; i < 25; ++i)
    EXPECT_NEAR(angles[i].get<double>() - angles[i - 1].get<double>(),
                angles[1].get<double>() - angles[0].get<double>(), 1e-6);  // floats
  for (const std::string wrong : {"ydlidar", "ydlidar:x2", "ydlidar:tg15"}) {
    const auto problems = named(decoded(wrong, file), "problem");
    ASSERT_EQ(problems.size(), 1U) << wrong;
    const std::string text = problems[0]["text"];
    EXPECT_NE(text.find("three bytes"), std::string::npos) << text;
    EXPECT_NE(text.find("COIN-D4"), std::string::npos) << text;
    EXPECT_NE(text.find("ydlidar:coin-d4"), std::string::npos) << text;
  }
}

TEST(Cases, a_coin_d4_read_as_a_model_with_samples_of_its_size_is_told_by_the_name_it_says) {
  SKIP_WITHOUT_CASES(folder);
  const auto file = folder / "coin-d4/coind4.txt";
  for (const std::string wrong : {"ydlidar:g2", "ydlidar:g4b", "ydlidar:tminipro"}) {
    const auto problems = named(decoded(wrong, file), "problem");
    ASSERT_EQ(problems.size(), 1U) << wrong;
    const std::string text = problems[0]["text"];
    EXPECT_NE(text.find("calls itself COIN-D4"), std::string::npos) << text;
    EXPECT_NE(text.find("set lidar.type to ydlidar:coin-d4"), std::string::npos) << text;
  }
  EXPECT_TRUE(named(decoded("ydlidar:coin-d4", file), "problem").empty());
}

/// Equal steps in equal times but for one note of a wild count; no interval without a word.
void expect_even_motion(const std::vector<json>& lines, double per_second, std::size_t least) {
  const auto ticks = of_type(lines, "ticks");
  ASSERT_GE(ticks.size(), least);
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double dt = ticks[i]["t"].get<double>() - ticks[i - 1]["t"].get<double>();
    for (const char* side : {"left", "right"})
      EXPECT_NEAR(std::abs(ticks[i][side].get<double>() - ticks[i - 1][side].get<double>()), per_second * dt,
                  1.01)
          << side << " at " << ticks[i]["t"];
  }
  EXPECT_EQ(named(lines, "wild_count").size(), lines.back()["rejected"]["tick_jumps"].get<std::size_t>());
  EXPECT_GE(named(lines, "wild_count").size(), 1U);
  EXPECT_TRUE(named(lines, "counter_restarted").empty());
}

TEST(Cases, a_wild_count_costs_no_motion) {
  SKIP_WITHOUT_CASES(folder);
  struct Case {
    const char *driver, *file;
    double per_second;
  };
  for (const Case& c :
       {Case{"canopen:cia402-pair", "spike.log", 2000.0},
        Case{"canopen:cia402-pair", "spike_mapped.log", 2000.0},
        Case{"canopen:zlac8015d", "zlac_spike.log", 1000.0}, Case{"agilex", "agilex_spike.log", 1000.0},
        Case{"odrive", "odrive_spike.log", 1000.0}, Case{"vesc", "vesc_spike.log", 200.0}}) {
    SCOPED_TRACE(std::string(c.driver) + " " + c.file);
    const auto lines = decoded(c.driver, folder / "wild-counts" / c.file);
    const bool long_log = std::string(c.file).starts_with("spike");
    expect_even_motion(lines, c.per_second, long_log ? 199U : 20U);
    EXPECT_LE(of_type(lines, "ticks").size(), 200U);
  }
}

TEST(Cases, what_candump_prints_on_the_screen_is_refused_with_what_helps) {
  SKIP_WITHOUT_CASES(folder);
  for (const std::string driver : {"canopen:zlac8015d", "vesc"}) {
    for (const std::string file : {"view.txt", "view_t.txt"}) {
      const auto text =
          decode(driver, test::read_text(folder / "candump-screen" / file), test::kProfiles, file);
      ASSERT_FALSE(text.ok()) << file;
      EXPECT_EQ(text.error().code, ErrorCode::format);
      EXPECT_NE(text.error().text().find("candump -L"), std::string::npos);
    }
  }
  const auto lines = decoded("canopen:cia402-pair", folder / "candump-screen/log.txt");
  EXPECT_EQ(lines.back()["rejected"]["bad_line"], 0);
  EXPECT_EQ(lines.back()["rejected"]["fd_frame"], 1);
  EXPECT_EQ(named(lines, "sdo_abort").size(), 4U);
}

TEST(Cases, a_network_capture_is_read_as_it_stands) {
  ODOMCALIB_CAPTURES(folder);
  const auto lines = decoded("sick", folder / "sick-tim781s/tim781s_1s.pcapng");
  const auto scans = of_type(lines, "scan");
  ASSERT_EQ(scans.size(), 16U);
  EXPECT_EQ(scans.front()["counter"], 44977);
  EXPECT_EQ(scans.back()["counter"], 44992);
  EXPECT_EQ(scans.front()["ranges"].size(), 811U);
  for (const auto& [name, count] : lines.back()["rejected"].items()) EXPECT_EQ(count, 0) << name;
  EXPECT_FALSE(decode("ld06", test::read_text(folder / "sick-tim781s/tim781s_1s.pcapng"), "", "f").ok());
}

}  // namespace
}  // namespace odomcalib::drivers::cases_test
