// Answers of a daemon of another version do not read as "all is well".
#include "daemon/cli/client.hpp"

#include <gtest/gtest.h>

namespace odomcalib::cli::answers_test {
namespace {

using nlohmann::ordered_json;

TEST(Answers, without_their_member_are_errors_that_name_it) {
  for (const char* text : {"{}", "[]", "null", "no JSON", R"({"check":[]})"}) {
    const auto answer = answer_with(ordered_json::parse(text, nullptr, false), "Check", "checks");
    ASSERT_FALSE(answer.ok()) << text;
    EXPECT_EQ(answer.error().code, ErrorCode::format);
    EXPECT_EQ(answer.error().what, "the daemon's answer has no checks");
  }
  EXPECT_TRUE(answer_with({{"checks", ordered_json::array()}}, "Check", "checks").ok());
  EXPECT_TRUE(answer_with(ordered_json::object(), "Stop", "").ok());
  EXPECT_FALSE(answer_with(ordered_json::array(), "Stop", "").ok());
}

TEST(Answers, with_an_outcome_that_is_not_known_stand_in_the_way) {
  for (const char* text : {R"({"outcome":"fail"})", R"({"outcome":"failed"})", R"({"outcome":1})", "{}", "3"})
    EXPECT_TRUE(stands_in_the_way(ordered_json::parse(text))) << text;
  for (const char* text : {R"({"outcome":"ok"})", R"({"outcome":"warn"})"})
    EXPECT_FALSE(stands_in_the_way(ordered_json::parse(text))) << text;
}

}  // namespace
}  // namespace odomcalib::cli::answers_test
