// Real programs in real time: whoever dies in mid-motion, the simulated wheels must come to rest. Times are
// taken from the simulator's own log of its true wheel speeds, in its clock.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "tests/integration/processes.hpp"

namespace odomcalib::test_support::process_test {
namespace {

using nlohmann::json;

constexpr double kClientGone = 0.250;  // s, from the death of the client to wheels at rest
constexpr double kDaemonGone = 0.500;  // s, the drive's own time-out of our heartbeat and its ramp
constexpr int kCancelled = 4, kProtectiveStop = 5, kDevice = 6, kKilled = 128 + SIGKILL;

class Processes : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
    client_ = both_.run({"straight", "--yes", "--distance", "1.5"});
    ASSERT_TRUE(wait_until([this] { return both_.rim() > 0.15; }, 20.0)) << both_.output() << both_.status();
  }
  void expect_rest_within(double limit, double since) {
    const auto time = both_.time_to_rest(since);
    ASSERT_TRUE(time.has_value()) << "the wheels still turn at " << both_.rim() << " m/s";
    RecordProperty("ms_to_rest", static_cast<int>(1000.0 * *time));
    std::printf("wheels at rest after %.0f ms\n", 1000.0 * *time);
    EXPECT_LE(*time, limit);
  }
  void expect_no_restart() {
    EXPECT_TRUE(wait_until([this] { return both_.ready(); }, 10.0)) << both_.status();
    EXPECT_LT(both_.rim(), 0.005);
  }
  std::string last_stop() {
    const auto status = json::parse(both_.status(), nullptr, false);
    return status.is_object() ? status.value("last_stop", "") : "";
  }

  RobotAndDaemon both_{3};
  std::unique_ptr<Process> client_;
};

TEST_F(Processes, a_killed_client_leaves_the_wheels_at_rest_within_250_ms) {
  const double begin = monotonic();
  client_->signal(SIGKILL);
  expect_rest_within(kClientGone, begin);
  EXPECT_EQ(client_->wait(5.0), kKilled);
  EXPECT_NE(last_stop(), "");
  expect_no_restart();
}

TEST_F(Processes, a_frozen_client_leaves_the_wheels_at_rest_within_250_ms) {
  const double begin = monotonic();
  client_->signal(SIGSTOP);
  expect_rest_within(kClientGone, begin);
  client_->signal(SIGCONT);
  EXPECT_EQ(client_->wait(5.0), kCancelled) << both_.output();
  expect_no_restart();
}

TEST_F(Processes, a_killed_daemon_leaves_the_wheels_at_rest_through_the_watchdog_of_the_drive) {
  const double begin = monotonic();
  both_.daemon->signal(SIGKILL);
  expect_rest_within(kDaemonGone, begin);
  const auto status = client_->wait(5.0);
  ASSERT_TRUE(status.has_value());
  EXPECT_NE(*status, 0);
  both_.start_daemon();
  expect_no_restart();
  EXPECT_NE(last_stop().find("without being stopped, during \"straight\""), std::string::npos) << last_stop();
}

TEST_F(Processes, a_command_while_the_robot_moves_ends_as_busy_and_waiting_outlasts_the_motion) {
  constexpr int kBusy = 12, kDone = 0;
  EXPECT_EQ(both_.run({"record", "--duration", "0.2"})->wait(5.0), kBusy) << both_.output();
  EXPECT_EQ(both_.run({"spin", "--yes"})->wait(5.0), kBusy) << both_.output();
  both_.run({"stop"})->wait(5.0);
  EXPECT_EQ(both_.run({"wait", "--until", "ready", "--timeout", "10"})->wait(12.0), kDone) << both_.output();
}

TEST_F(Processes, a_cut_bus_leaves_the_wheels_at_rest_and_is_reported_by_name) {
  const double begin = monotonic();
  both_.robot->tell("cut can");
  expect_rest_within(kDaemonGone, begin);
  const auto status = client_->wait(5.0);
  EXPECT_TRUE(status == kProtectiveStop || status == kDevice) << status.value_or(-1) << both_.output();
  EXPECT_NE(last_stop(), "");
  EXPECT_TRUE(
      wait_until([this] { return json::parse(both_.status())["controller"]["state"] == "absent"; }, 5.0))
      << both_.status();
  both_.robot->tell("restore can");
  expect_no_restart();
}

TEST_F(Processes, a_daemon_that_is_told_to_end_leaves_the_wheels_at_rest) {
  const double begin = monotonic();
  both_.daemon->signal(SIGTERM);
  expect_rest_within(kClientGone, begin);
  EXPECT_EQ(both_.daemon->wait(5.0), 0);
}

class ClientSignal : public Processes, public ::testing::WithParamInterface<int> {};

TEST_P(ClientSignal, stops_the_robot_within_250_ms_and_ends_the_client_as_cancelled) {
  const double begin = monotonic();
  client_->signal(GetParam());
  expect_rest_within(kClientGone, begin);
  EXPECT_EQ(client_->wait(5.0), kCancelled) << both_.output();
  expect_no_restart();
}

INSTANTIATE_TEST_SUITE_P(Processes, ClientSignal, ::testing::Values(SIGINT, SIGHUP, SIGTERM, SIGTSTP));

}  // namespace
}  // namespace odomcalib::test_support::process_test
