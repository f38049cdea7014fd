// Counts of a comparison of two versions of the program on the same recordings.
#include "tests/blind/paired_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace odomcalib::blind::paired_table_test {
namespace {

/// A robot whose wheel is off its centre.
Trial eccentric(unsigned number, bool named) {
  Trial trial;
  trial.answer.number = number;
  trial.answer.effects.emplace_back();
  trial.answer.effects.front().catalogue_name = "wheel_eccentricity";
  trial.twin.position.rms = 1.0;
  trial.before.position = {2.0, 2.2};
  trial.after.position.rms = named ? 1.0 : 2.0;
  if (named) trial.named = {"wheel_eccentricity"};
  return trial;
}

TEST(PairedTable, counts_each_recording_that_both_have_once_and_under_who_is_right) {
  const std::vector<Trial> one = {eccentric(0, true), eccentric(1, true), eccentric(2, false),
                                  eccentric(9, true)};
  const std::vector<Trial> other = {eccentric(2, false), eccentric(1, false), eccentric(0, true)};
  const std::string text = paired_table(one, other);
  EXPECT_THAT(text, testing::HasSubstr("| 3 recordings |"));
  EXPECT_THAT(text, testing::HasSubstr("that hurts: named | 1 | 1 | 0 | 1 | 1.00 |"));
  EXPECT_THAT(text, testing::HasSubstr("none reported | 0 | 0 | 0 | 0 | 1.00 |")) << "each has an effect";
  EXPECT_THAT(text, testing::HasSubstr("(median ratio 1.000) | 2 | 1 | 0 |"));
}

// By hand: 2 (1 + 10) / 2^10.
TEST(PairedTable, calls_an_uneven_split_improbable_and_an_even_one_not) {
  EXPECT_NEAR(sign_test(9, 1), 22.0 / 1024.0, 1e-12);
  EXPECT_EQ(sign_test(9, 1), sign_test(1, 9));
  EXPECT_EQ(sign_test(5, 5), 1.0);
  EXPECT_EQ(sign_test(0, 0), 1.0);
}

}  // namespace
}  // namespace odomcalib::blind::paired_table_test
