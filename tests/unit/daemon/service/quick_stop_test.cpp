// The stop that follows a daemon that has ended.
#include "daemon/service/quick_stop.hpp"

#include <gtest/gtest.h>

#include "tests/sim/wires/pty.hpp"

namespace odomcalib::quick_stop_test {
namespace {

Config config_of(const std::string& port) {
  Config config;
  config.controller_device = "serial:" + port + "?baud=57600";
  config.controller_profile = "drivers/base/profiles/ros_arduino.toml";
  return config;
}

TEST(QuickStop, is_sent_more_than_once_and_nothing_that_moves) {
  auto pty = std::move(sim::Pty::open()).value();
  const double begin = SystemClock().now();
  const auto stopped = quick_stop(config_of(pty->path()), SystemClock());
  EXPECT_GE(SystemClock().now() - begin, 0.5) << "a drive may take so long to be identified";
  ASSERT_TRUE(stopped.ok()) << stopped.error().text();
  const std::string sent = pty->read();
  std::size_t stops = 0;
  for (std::size_t at = 0; (at = sent.find("m 0 0\r", at)) != std::string::npos; ++at) ++stops;
  EXPECT_GE(stops, 2U) << sent;
  for (std::size_t at = 0; (at = sent.find("m ", at)) != std::string::npos; ++at)
    EXPECT_EQ(sent.substr(at, 6), "m 0 0\r") << sent;
}

// Its set-up takes longer than the stop itself is sent.
TEST(QuickStop, waits_for_an_adapter_that_answers_nothing) {
  auto pty = std::move(sim::Pty::open()).value();
  Config config;
  config.controller_device = "slcan:" + pty->path() + "?bitrate=500000";
  config.controller_profile = "drivers/base/profiles/vesc.toml";
  const auto stopped = quick_stop(config, SystemClock());
  ASSERT_TRUE(stopped.ok()) << stopped.error().text();
  const std::string sent = pty->read();
  const std::size_t open = sent.find("O\r");
  ASSERT_NE(open, std::string::npos) << sent;
  EXPECT_NE(sent.find('T', open), std::string::npos) << "no frame: " << sent;
}

TEST(QuickStop, of_a_line_that_is_away_says_so) {
  const auto stopped = quick_stop(config_of("/dev/odomcalib-no-such-port"), SystemClock());
  ASSERT_FALSE(stopped.ok());
  EXPECT_NE(stopped.error().text().find("/dev/odomcalib-no-such-port"), std::string::npos);
}

}  // namespace
}  // namespace odomcalib::quick_stop_test
