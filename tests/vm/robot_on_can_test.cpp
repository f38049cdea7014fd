// The whole daemon and the simulated robot on CAN interfaces of the kernel: what breaks on the bus in
// mid-motion ends in a named state with the wheels at rest, and nothing moves again by itself.
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/processes.hpp"
#include "tests/vm/can_bench.hpp"

namespace odomcalib::vm {
namespace {

using nlohmann::json;
using test_support::CanWiring;
using test_support::Process;
using test_support::RobotAndDaemon;

constexpr double kPause = 0.1;     // s between questions: each costs an emulated processor much
constexpr double kToRest = 0.500;  // s: 100 ms to notice, 100 ms to command, the drive's own 200 ms, its ramp

// Starting everything takes long on an emulated processor: robot and daemon live as long as their cases
// succeed.
class RobotOnCan : public ::testing::Test {
 protected:
  void TearDown() override {
    if (HasFailure()) both_.reset();
  }
  static void TearDownTestSuite() { both_.reset(); }

  static void start(const CanWiring& wiring) {
    if (!both_) both_ = std::make_unique<RobotAndDaemon>(3, wiring);
    ASSERT_TRUE(wait_until([] { return both_->ready(); }, 20.0, kPause)) << both_->status();
  }
  /// An emulated processor may pause for longer than the limits of safety, and a stop by them is no fault of
  /// the case: the motion is then started again, as a user would, and the log says so.
  void drive() {
    constexpr int kAttempts = 3;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
      client_ = both_->run({"straight", "--yes", "--distance", "0.3"});
      (void)wait_until([this] { return both_->rim() > 0.15 || client_->wait(0.0); }, 20.0, 0.02);
      if (both_->rim() > 0.15) return;
      std::printf("attempt %d did not move: %s\n", attempt, both_->output().c_str());
      (void)wait_until([] { return both_->ready(); }, 20.0, kPause);
    }
    FAIL() << both_->status();
  }
  static json status() { return json::parse(both_->status(), nullptr, false); }
  static std::string last_stop() {
    const json now = status();
    return now.is_object() ? now.value("last_stop", "") : "";
  }
  static void expect_rest(double since, const std::string& name, double limit = kToRest) {
    const auto time = both_->time_to_rest(since);
    ASSERT_TRUE(time.has_value()) << "the wheels still turn at " << both_->rim() << " m/s";
    std::printf("wheels at rest after %.0f ms: %s\n", 1e3 * *time, last_stop().c_str());
    EXPECT_LE(*time, limit);
    EXPECT_NE(last_stop().find(name), std::string::npos) << last_stop();
  }
  /// At rest in time, stopped by name, the client told.
  void expect_stop(double since, const std::string& name, double limit = kToRest) {
    expect_rest(since, name, limit);
    const auto ended = client_->wait(10.0);
    EXPECT_TRUE(ended == 5 || ended == 6) << ended.value_or(-1) << both_->output();
  }
  static void expect_ready_and_at_rest(double seconds) {
    const double begin = monotonic();
    EXPECT_TRUE(wait_until([] { return both_->ready(); }, seconds, kPause)) << both_->status();
    std::printf("ready again after %.1f s\n", monotonic() - begin);
    EXPECT_LT(both_->rim(), 0.005);
  }

  static inline std::unique_ptr<RobotAndDaemon> both_;
  std::unique_ptr<Process> client_;
};

class RobotOnVcan : public RobotOnCan {
 protected:
  static void SetUpTestSuite() { bus_ = std::make_unique<Vcan>("vcan0"); }
  static void TearDownTestSuite() {
    RobotOnCan::TearDownTestSuite();
    bus_.reset();
  }
  void SetUp() override {
    start({"vcan0", "vcan0"});
    if (!HasFatalFailure()) drive();
  }

  static inline std::unique_ptr<Vcan> bus_;
};

TEST_F(RobotOnVcan, F15_interface_down_and_up) {
  const double begin = monotonic();
  bus_->down();
  expect_stop(begin, "");
  EXPECT_TRUE(wait_until([] { return status()["controller"]["state"] == "absent"; }, 2.0, kPause))
      << both_->status();
  EXPECT_NE(status()["controller"]["problem"].get<std::string>().find("ip link set vcan0 up"),
            std::string::npos)
      << both_->status();
  bus_->up();
  expect_ready_and_at_rest(5.0);
  EXPECT_EQ(status()["controller"]["problem"], "");
}

TEST_F(RobotOnVcan, F1_the_adapter_is_pulled_out_and_plugged_in) {
  const double begin = monotonic();
  bus_->remove();
  expect_stop(begin, "");
  EXPECT_TRUE(wait_until([] { return status()["controller"]["connected"] == false; }, 2.0, kPause))
      << both_->status();
  const double processor = both_->daemon->processor_time();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const double share = (both_->daemon->processor_time() - processor) / 2.0;
  std::printf("processor share while the adapter is away: %.1f %%\n", 1e2 * share);
  EXPECT_LT(share, 0.05);
  EXPECT_TRUE(status()["controller"]["state"] == "absent") << both_->status();
  bus_->create();
  EXPECT_TRUE(Peer("vcan0").receive(2.0).has_value()) << "the daemon does not talk on the new interface";
  both_.reset();  // the simulated robot's own socket was on the old one
}

TEST_F(RobotOnVcan, F2_bus_off) {
  const Peer peer("vcan0");
  const double begin = monotonic();
  ASSERT_TRUE(peer.send(error_of(CAN_ERR_FLAG | 0x040)));
  expect_stop(begin, "bus_off");
  expect_ready_and_at_rest(5.0);
}

TEST_F(RobotOnVcan, F3_error_passive_storm) {
  const Peer peer("vcan0");
  const double begin = monotonic();
  for (int i = 0; i < 2000; ++i) {
    (void)peer.send(error_of(0x004, {0, 0x20, 0, 0, 0, 0, 0x80, 0}));
    if (i % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  expect_stop(begin, "error_passive");
  expect_ready_and_at_rest(5.0);
}

// 3900 frames/s of 8 bytes are a full bus at 500 kbit/s; none of them is ours.
TEST_F(RobotOnVcan, F4_full_bus_load_of_foreign_frames_does_not_disturb_a_motion) {
  const Peer peer("vcan0");
  std::uint64_t sent = 0;
  const double begin = monotonic();
  while (!client_->wait(0.0) && monotonic() < begin + 30.0) {
    const auto due = static_cast<std::uint64_t>(3900.0 * (monotonic() - begin));
    for (; sent < due; ++sent) (void)peer.send(frame_of(0x3A5, {1, 2, 3, 4, 5, 6, 7, 8}));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(client_->wait(1.0), 0) << both_->output() << both_->status();
  const json counters = status()["controller"]["counters"];
  std::printf("%lu foreign frames, lost in the socket: %s\n", sent,
              counters["lost_in_socket"].dump().c_str());
  EXPECT_EQ(counters["lost_in_socket"], 0);
  EXPECT_EQ(counters["send_failed"], 0);
}

TEST_F(RobotOnVcan, F5_a_second_node_with_the_same_id) {
  const Peer twin("vcan0");
  const double begin = monotonic();
  // Its own idea of the counters and its own life signs, as if a drive was bought and never given an address.
  for (int i = 0; i < 50; ++i) {
    (void)twin.send(frame_of(0x181, {0x39, 0x30, 0, 0, 0x39, 0x30, 0, 0}));
    (void)twin.send(frame_of(0x701, {0x7F}));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  expect_stop(begin, "");
  EXPECT_NE(last_stop(), "");
  expect_ready_and_at_rest(8.0);
}

TEST_F(RobotOnVcan, F6_controller_reset) {
  const double begin = monotonic();
  both_->robot->tell("reset drive");
  expect_stop(begin, "");
  expect_ready_and_at_rest(8.0);
}

TEST_F(RobotOnVcan, F7_heartbeat_lost) {
  const double begin = monotonic();
  both_->robot->tell("silence heartbeat");
  expect_stop(begin, "heartbeat_lost", 0.1 + kToRest);  // three heartbeats of 30 ms must be missing first
  both_->robot->tell("speak heartbeat");
  expect_ready_and_at_rest(8.0);
}

TEST_F(RobotOnVcan, a_killed_daemon_leaves_the_stop_to_the_drive) {
  const double begin = monotonic();
  both_->daemon->signal(SIGKILL);
  const auto time = both_->time_to_rest(begin);
  ASSERT_TRUE(time.has_value());
  std::printf("wheels at rest after %.0f ms\n", 1e3 * *time);
  EXPECT_LE(*time, kToRest);
  both_->start_daemon();
  expect_ready_and_at_rest(10.0);
}

class RobotOnCards : public RobotOnCan {
 protected:
  void SetUp() override {
    if (!cards_up()) GTEST_SKIP() << kNoCards;
    start({"can1", "can0"});
  }
};

TEST_F(RobotOnCards, a_straight_comes_to_its_end_through_real_controller_drivers) {
  drive();
  EXPECT_EQ(client_->wait(40.0), 0) << both_->output() << both_->status();
}

TEST_F(RobotOnCards, a_card_that_goes_down_and_comes_up_ends_in_a_stop_and_is_ready_again) {
  drive();
  const double begin = monotonic();
  ip("link set can0 down");
  expect_stop(begin, "");
  ip("link set can0 up type can bitrate 500000");
  expect_ready_and_at_rest(5.0);
}

}  // namespace
}  // namespace odomcalib::vm
