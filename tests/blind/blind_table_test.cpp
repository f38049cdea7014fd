// Rows of the blind test, and what its tables make of them.
#include "tests/blind/blind_table.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/blind/ablation.hpp"
#include "tests/blind/paired_table.hpp"

namespace odomcalib::blind::blind_table_test {
namespace {

/// A robot without an effect, of which nothing but findings is known.
Trial judged_by_findings(unsigned number) {
  Trial trial;
  trial.answer.campaign = 7;
  trial.answer.number = number;
  trial.answer.drive = "guided";
  trial.judged = Judged::by_its_findings;
  trial.sigmas = {1.0, -2.0, 3.5};
  return trial;
}

/// Backlash, found by its name, on a fresh drive.
Trial judged_by_a_drive(unsigned number) {
  Trial trial = judged_by_findings(number);
  trial.judged = Judged::by_a_fresh_drive;
  trial.answer.effects = {{"gear_play", "backlash", {"reversal"}, 0.0123456789, "rad"}};
  trial.named = {"backlash"};
  trial.residual_over_floor = {1.0, 1.5, 2.0};
  trial.before = {{4e-3, 5e-3}, {0.02, 0.03}};
  trial.after = {{1.1e-3, 2e-3}, {0.01, 0.02}};
  trial.twin = {{1e-3, 2e-3}, {0.01, 0.02}};
  return trial;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(BlindRows, come_back_with_five_digits) {
  const Trial back = trial_from_json_line(to_json_line(judged_by_a_drive(3)));
  EXPECT_EQ(back.judged, Judged::by_a_fresh_drive);
  EXPECT_EQ(back.answer.number, 3U);
  EXPECT_EQ(back.answer.effects.front().size, 0.012346);
  EXPECT_EQ(back.after.position.rms, 1.1e-3);
  EXPECT_EQ(back.named, std::vector<std::string>{"backlash"});
}

TEST(BlindRows, without_a_fresh_drive_say_nothing_of_one) {
  const std::string line = to_json_line(judged_by_findings(4));
  EXPECT_FALSE(contains(line, "after"));
  EXPECT_EQ(trial_from_json_line(line).judged, Judged::by_its_findings);
}

TEST(BlindTable, states_the_exact_interval_of_false_findings) {
  std::vector<Trial> trials(35, judged_by_findings(0));
  EXPECT_TRUE(contains(campaign_table(trials), "0 of 35 (0.0 %), 95 %: 0.00 to 10.00 %"))
      << campaign_table(trials);
  trials[3].depends_on = {"speed"};
  EXPECT_TRUE(contains(table(trials), "1 of 35 (2.9 %), 95 %: 0.07 to 14.92 %")) << table(trials);
}

TEST(BlindTable, has_a_line_for_each_campaign) {
  std::vector<Trial> trials = {judged_by_findings(0), judged_by_a_drive(1)};
  trials[1].answer.campaign = 8;
  const std::string text = campaign_table(trials);
  EXPECT_TRUE(contains(text, "| 7 | 1 | – | – | 0 of 1 ")) << text;
  EXPECT_TRUE(contains(text, "| 8 | 1 | 1 of 1 | – | – | 2 of 3 | 0 of 1 | 1.10, 1.10 |")) << text;
  EXPECT_TRUE(contains(text, "| all | 2 | 1 of 1 | – | 0 of 1 ")) << text;
}

TEST(BlindTable, counts_drives_of_those_that_had_one) {
  const std::vector<Trial> trials = {judged_by_findings(0), judged_by_findings(1), judged_by_a_drive(2)};
  const std::string text = table(trials);
  EXPECT_TRUE(contains(text, "above the plain fit's | 0 of 1 (0.0 %)")) << text;
  EXPECT_TRUE(contains(text, "the same, plain fit | 3 of 3 ")) << text;
  EXPECT_TRUE(contains(text, "| (none) | 2 | 0 | 0 | – | – |")) << text;
  EXPECT_TRUE(contains(paired_table(trials, trials), "than by the plain fit | 1 | 0 | 0 | 0 |"));
}

TEST(Ablation, of_a_calibration_that_does_not_change_is_a_short_line) {
  const Trial trial = judged_by_a_drive(1);
  EXPECT_TRUE(contains(to_json_line(Ablation{"", false, trial}), "is_right"));
  EXPECT_TRUE(contains(to_json_line(Ablation{"chance", true, trial}), "is_right"));
  EXPECT_FALSE(contains(to_json_line(Ablation{"chance", false, trial}), "is_right"));
}

TEST(Ablation, leaves_out_a_rule_or_a_group_by_name) {
  using calib::selection::Rule;
  EXPECT_FALSE(rules_without({"few_bends"}).has(Rule::few_bends));
  EXPECT_FALSE(rules_without({"wrong_shape"}).has(Rule::few_bends));
  EXPECT_TRUE(rules_without({}).has(Rule::few_bends));
  EXPECT_FALSE(rules_without({"few_bends", "chance"}).has(Rule::few_bends));
  EXPECT_FALSE(rules_without({"few_bends", "chance"}).has(Rule::significance));
  EXPECT_THROW(rules_without({"no_such_rule"}), std::invalid_argument);
}

}  // namespace
}  // namespace odomcalib::blind::blind_table_test
