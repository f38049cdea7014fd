#include "daemon/service/parts/link_watch.hpp"

#include <gtest/gtest.h>

namespace odomcalib::link_watch_test {
namespace {

const Error kAbsent{ErrorCode::io, "No such file or directory", "/dev/ttyUSB0", "connect it"};
const Error kGone{ErrorCode::io, "Input/output error", "/dev/ttyUSB0", ""};

TEST(LinkWatch, reports_what_happens_once_with_its_reason) {
  LinkWatch watch;
  const auto look = [&watch](bool connected, const std::optional<Error>& problem) {
    const auto news = watch.look("serial:/dev/ttyUSB0", connected, problem);
    return news ? (news->good ? "+ " : "- ") + news->text : "";
  };
  EXPECT_EQ(look(false, std::nullopt), "");
  EXPECT_NE(look(false, kAbsent).find("No such file"), std::string::npos);
  EXPECT_EQ(look(false, kAbsent), "") << "each attempt to open it again";
  EXPECT_EQ(look(true, std::nullopt), "+ serial:/dev/ttyUSB0 is connected");
  EXPECT_EQ(look(true, std::nullopt), "");
  const std::string lost = look(false, kGone);
  EXPECT_NE(lost.find("is lost"), std::string::npos) << lost;
  EXPECT_NE(lost.find("Input/output error"), std::string::npos) << lost;
  EXPECT_EQ(look(true, std::nullopt), "+ serial:/dev/ttyUSB0 is connected");
}

TEST(LinkWatch, reports_a_line_that_is_open_and_says_nothing_useful) {
  LinkWatch watch;
  (void)watch.look("tcp:lidar", true, std::nullopt);
  const Error silent{ErrorCode::timeout, "connected, but nothing arrives", "tcp:lidar", "check power"};
  const auto news = watch.look("tcp:lidar", true, silent);
  ASSERT_TRUE(news);
  EXPECT_FALSE(news->good);
  const auto again = watch.look("tcp:lidar", true, std::nullopt);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->good);
}

}  // namespace
}  // namespace odomcalib::link_watch_test
