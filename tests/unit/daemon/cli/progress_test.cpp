#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "daemon/cli/output.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli::progress_test {
namespace {

void pass(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// Standard error of these tests is a file, as in a log.
TEST(Progress, is_a_plain_line_now_and_then_with_what_is_left_where_no_terminal_is) {
  testing::internal::CaptureStderr();
  ProgressLine line;
  line.show("matching", 0.0);
  pass(settings::kQuiet_s + 0.1);
  line.show("matching", 0.5);
  line.show("matching", 0.6);
  line.clear();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "matching  50 %, 2 s left of it; 2 s so far\n");
}

TEST(Progress, of_a_step_that_begins_anew_is_not_foretold_from_the_one_before) {
  testing::internal::CaptureStderr();
  ProgressLine line;
  line.show("matching", 0.9);
  pass(settings::kQuiet_s + 0.1);
  line.show("matching", 0.1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "matching  10 %; 2 s so far\n");
}

TEST(Progress, is_shown_of_what_does_not_say_how_far_it_is_and_not_of_what_ends_soon) {
  testing::internal::CaptureStderr();
  { const Meanwhile soon("reading a.mcap"); }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  testing::internal::CaptureStderr();
  {
    const Meanwhile reading("reading b.mcap");
    pass(settings::kQuiet_s + 1.0);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr().substr(0, 16), "reading b.mcap, ");
}

}  // namespace
}  // namespace odomcalib::cli::progress_test
