// The summary of a calibration fits a screen, whatever was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli::summary_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kColumns = 80;

Calibration example() {
  Calibration calibration;
  calibration.robot.left_wheel_diameter = calibration.robot.right_wheel_diameter = 0.15;
  calibration.robot.track_width = 0.4;
  for (const char* name : {"left_wheel_diameter", "right_wheel_diameter", "track_width"})
    calibration.parameters.emplace_back(name, Quantity{0.147, 1e-4, "m"});
  for (const char* name : {"lidar_x", "lidar_y"})
    calibration.parameters.emplace_back(name, Quantity{0.1, 1e-4, "m"});
  calibration.parameters.emplace_back("lidar_yaw", Quantity{0.01, 1e-4, "rad"});
  calibration.verdict = Verdict::accepted;
  calibration.reasons.clear();
  ReportData data;
  for (const char* name : {"straight_metre_length", "straight_metre_heading", "full_turn_heading",
                           "open_loop_10s_position", "open_loop_10s_heading"})
    data.drive_errors.push_back({name, "m", 12, Bounded{0.0204, 0.02, 0.021}, Bounded{0.002, 0.001, 0.003},
                                 Bounded{0.0011, 0.0009, 0.0014}, 0.001});
  store_report_data(data, calibration);
  return calibration;
}

void add_effects(Calibration& calibration, int count) {
  for (int k = 0; k < count; ++k) {
    EffectResult effect;
    effect.name = "effect_" + std::to_string(k);
    effect.parameters = {{"size", {0.01, 0.001, "1"}}};
    effect.aliases = {"another_effect", "and_still_another_one"};
    effect.stored_in = "host";
    calibration.effects.push_back(effect);
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

void expect_a_screen(const std::string& text) {
  const auto lines = lines_of(text);
  EXPECT_LE(lines.size(), static_cast<std::size_t>(settings::kSummaryLines)) << text;
  for (const std::string& line : lines) EXPECT_LE(line.size(), kColumns) << line;
}

TEST(Summary, has_verdict_values_errors_and_what_was_found_and_leaves_the_rest) {
  auto calibration = example();
  add_effects(calibration, 2);
  calibration.linear_correction = LinearCorrection{};
  const std::string text = summary(calibration, true, kColumns);
  expect_a_screen(text);
  for (const char* said :
       {"ACCEPTED", "Next: odomcalibctl apply", "A metre read 20.4 mm too long, now 1.1 mm off", "lidar yaw",
        "10 s without reference: heading", "floor  stretches", "effect 1: size",
        "effect 0 cannot be separated from", "--verbose"})
    EXPECT_THAT(text, HasSubstr(said));
  for (const char* rest : {"Linear correction", "20.40 (20.00..21.00)"})
    EXPECT_THAT(text, Not(HasSubstr(rest)));
}

TEST(Summary, says_what_was_left_out_unless_it_is_a_trace_or_a_reason_already) {
  auto calibration = example();
  DataUse data;
  data.begin = 100.0;
  calibration.data = {data};
  calibration.discarded = {{"interval", "count does not continue", 9, 1000, 103.2, 171.0},
                           {"beam", "not a number", 900, 1000},
                           {"scan", "repeated time stamp", 200, 1000, 100.5, 160.0},
                           {"interval", "jump", 300, 1000, 103.2, 171.0},
                           {"pair", "match: no_overlap", 100, 1000}};
  const std::string text = summary(calibration, true, kColumns);
  expect_a_screen(text);
  EXPECT_THAT(text, HasSubstr("Left out: 300 of 1000 intervals between counts (30 %), from 3.2 to 71 s"));
  EXPECT_LT(text.find("300 of 1000"), text.find("200 of 1000")) << "most first";
  EXPECT_THAT(text, Not(HasSubstr("9 of 1000 intervals")));
  EXPECT_THAT(text, Not(HasSubstr("900 of 1000")));
  calibration.reasons = {"300 of 1000 intervals between counts (30 %), from 3.2 to 71 s: jump; what now"};
  EXPECT_THAT(summary(calibration, true, kColumns), Not(HasSubstr("Left out: 300")));
}

TEST(Summary, says_no_more_than_three_times_that_something_was_left_out) {
  auto calibration = example();
  for (const char* reason : {"a", "b", "c", "d"})
    calibration.discarded.push_back({"scan", reason, 100, 1000});
  const std::string text = summary(calibration, true, kColumns);
  EXPECT_THAT(text, HasSubstr("(10 %): c"));
  EXPECT_THAT(text, Not(HasSubstr("(10 %): d")));
}

TEST(Summary, fits_a_screen_with_many_reasons_and_effects) {
  auto calibration = example();
  calibration.verdict = Verdict::accepted_with_warnings;
  add_effects(calibration, 6);
  for (int k = 0; k < 20; ++k)
    calibration.reasons.push_back("reason " + std::to_string(k) +
                                  " has so much to say that no line holds it, " +
                                  "not even one of eighty columns");
  const std::string text = summary(calibration, true, kColumns);
  expect_a_screen(text);
  EXPECT_THAT(text, HasSubstr("reason 0 "));
  EXPECT_THAT(text, HasSubstr("and 18 more: --verbose"));
  EXPECT_THAT(text, HasSubstr("effect 5: size"));
  EXPECT_THAT(text, HasSubstr("lidar yaw"));
}

TEST(Summary, of_a_refusal_has_the_reasons) {
  Calibration calibration;
  calibration.reasons = {"no data"};
  const std::string text = summary(calibration, true, kColumns);
  EXPECT_THAT(text, HasSubstr("REFUSED"));
  EXPECT_THAT(text, HasSubstr("no data"));
}

}  // namespace
}  // namespace odomcalib::cli::summary_test
