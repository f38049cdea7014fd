// Text that others wrote, as a terminal gets it.
#include "proto/visible_text.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <sstream>

namespace odomcalib::visible_text_test {
namespace {

TEST(VisibleText, leaves_what_is_to_be_read) {
  for (const char* text : {"", "plain\ttext\n", "± 0.1 mm, µ, €, 車輪, 🤖"})
    EXPECT_EQ(visible(text), text);
}

TEST(VisibleText, has_no_character_that_steers_a_terminal) {
  EXPECT_EQ(visible("\x1b[2Jgone\r\a\b\x7f"), "?[2Jgone????");
  EXPECT_EQ(visible(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(visible("csi \xC2\x9B"
                    "31m, osc \xC2\x9D"),
            "csi ?31m, osc ?")
      << "the same ones, of ISO 8859";
  EXPECT_EQ(visible("\xC2\xA0"), "\xC2\xA0") << "the first that is none";
}

TEST(VisibleText, has_no_byte_that_is_no_text) {
  for (const char* text : {"\x9B", "\xC0\x9B", "\xC1\xBF", "\xE0\x82\x9B", "\xF0\x80\x82\x9B", "\xED\xA0\x80",
                           "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80", "\xE2\x82", "\xC2"}) {
    const std::string shown = visible(text);
    EXPECT_EQ(shown, std::string(shown.size(), '?')) << text;
  }
  EXPECT_EQ(visible("\xE2\x82"
                    "A\xC2"),
            "??A?");
}

/// Every pair of bytes: what comes out is the same when it is looked at again.
TEST(VisibleText, is_visible) {
  for (int first = 0; first < 256; ++first)
    for (int second = 0; second < 256; ++second) {
      const std::string shown = visible(std::string{static_cast<char>(first), static_cast<char>(second)});
      ASSERT_EQ(visible(shown), shown);
      for (const char byte : shown)
        ASSERT_TRUE((static_cast<unsigned char>(byte) >= 0x20 && byte != 0x7F) || byte == '\n' ||
                    byte == '\t');
    }
}

TEST(VisibleText, is_what_a_stream_hands_on) {
  std::ostringstream terminal;
  VisibleText between(*terminal.rdbuf());
  std::ostream out(&between);
  out << "reason \x1b]0;title\a" << '\r' << 1.5 << " ±" << std::endl;
  EXPECT_EQ(terminal.str(), "reason ?]0;title??1.5 ±\n");
  EXPECT_TRUE(out.good());
}

}  // namespace
}  // namespace odomcalib::visible_text_test
