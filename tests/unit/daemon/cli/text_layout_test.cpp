#include "daemon/cli/text_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace odomcalib::cli::text_layout_test {
namespace {

using ::testing::HasSubstr;

std::size_t widest_line(const std::string& text) {
  std::istringstream in(text);
  std::size_t widest = 0;
  for (std::string line; std::getline(in, line);) widest = std::max(widest, line.size());
  return widest;
}

TEST(TextLayout, breaks_sentences_between_words_and_indents_what_follows) {
  EXPECT_EQ(wrapped("  a short one", 80), "  a short one\n");
  EXPECT_EQ(wrapped("  drive where the lidar sees walls", 20),
            "  drive where the\n      lidar sees\n      walls\n");
}

TEST(TextLayout, keeps_a_path_whole) {
  const std::string path = "/var/lib/odomcalib/recordings/straight.lcmlog";
  EXPECT_EQ(wrapped("recording " + path, 30), "recording\n    " + path + "\n");
}

TEST(TextLayout, breaks_a_command_so_that_a_shell_takes_it) {
  EXPECT_EQ(wrapped_command("Next: set a=1", 80), "Next: set a=1\n");
  EXPECT_EQ(wrapped_command("Next: set left=0.15 right=0.15", 22),
            "Next: set left=0.15 \\\n    right=0.15\n");
}

TEST(TextLayout, leaves_a_message_that_fits_on_its_line) {
  EXPECT_EQ(wrapped_message("a.bag: no scans; name them; see --topic", 80),
            "a.bag: no scans; name them; see --topic\n");
}

TEST(TextLayout, begins_a_line_with_each_sentence_of_a_message_and_with_its_command) {
  EXPECT_EQ(
      wrapped_message(
          "a.bag: it holds no scans; name their topic; see what it holds: odomcalibctl inspect a.bag", 40),
      "a.bag: it holds no scans\n"
      "    name their topic\n"
      "    see what it holds:\n"
      "    odomcalibctl inspect a.bag\n");
  EXPECT_EQ(wrapped_message("a.bag: its scans stand on no topic that is known here", 30),
            "a.bag: its scans stand on no\n    topic that is known here\n");
}

TEST(TextLayout, breaks_a_long_command_of_a_message_so_that_a_shell_takes_it) {
  EXPECT_EQ(wrapped_message("it is another: odomcalibctl solve a.bag --topic odometry=/wheels", 30),
            "it is another:\n"
            "    odomcalibctl solve a.bag \\\n"
            "        --topic \\\n"
            "        odometry=/wheels\n");
}

const Table kErrors{{"", "before", "noise floor"},
                    {{"a metre: length", "20.99 (20.83..21.15)", "0.39"}, {"a metre: heading", "-", "0.09"}}};

TEST(TextLayout, leaves_a_table_that_fits_as_it_is) {
  EXPECT_EQ(laid_out(kErrors, true, kAnyWidth),
            "                                  before  noise floor\n"
            "  a metre: length   20.99 (20.83..21.15)         0.39\n"
            "  a metre: heading                     -         0.09\n");
  EXPECT_EQ(laid_out(kErrors, false, 80).find("noise"), std::string::npos);
}

TEST(TextLayout, breaks_heads_before_cells) {
  EXPECT_EQ(laid_out(kErrors, true, 50),
            "                                          noise\n"
            "                                  before  floor\n"
            "  a metre: length   20.99 (20.83..21.15)   0.39\n"
            "  a metre: heading                     -   0.09\n");
  const std::string narrow = laid_out(kErrors, true, 40);
  EXPECT_LE(widest_line(narrow), 40U) << narrow;
  EXPECT_THAT(narrow, HasSubstr("(20.83..21.15)"));
}

TEST(TextLayout, aligns_words_left_and_numbers_right) {
  EXPECT_EQ(laid_out({{"check", "found", "m"}, {{"bus", "open", "1.5"}, {"scans", "none arrive", "12.5"}}},
                     true, 80),
            "  check  found           m\n"
            "  bus    open          1.5\n"
            "  scans  none arrive  12.5\n");
}

TEST(TextLayout, repeats_the_first_column_where_columns_have_to_be_shown_in_blocks) {
  Table wide{{""}, {{"track width"}, {"lidar yaw"}}};
  for (int k = 0; k < 12; ++k) {
    wide.head.push_back("parameter" + std::to_string(k));
    for (auto& row : wide.rows) row.push_back("0.25");
  }
  const std::string text = laid_out(wide, true, 80);
  EXPECT_LE(widest_line(text), 80U) << text;
  for (int k = 0; k < 12; ++k) EXPECT_THAT(text, HasSubstr("parameter" + std::to_string(k)));
  const auto first = text.find("track width");
  EXPECT_NE(text.find("track width", first + 1), std::string::npos) << text;
}

TEST(TextLayout, counts_columns_and_no_bytes) { EXPECT_EQ(wrapped("± ± ±", 5), "± ± ±\n"); }

TEST(TextLayout, of_nothing_is_nothing) {
  EXPECT_EQ(laid_out({}, true, 80), "");
  EXPECT_EQ(wrapped("", 80), "\n");
}

}  // namespace
}  // namespace odomcalib::cli::text_layout_test
