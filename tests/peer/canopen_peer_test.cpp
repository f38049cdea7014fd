// Our CANopen master against a drive made of somebody else's stack (peer.js), through an slcan
// pseudo-terminal in real time. What both ends misread alike in tests of our own would show here.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "drivers/base/controller.hpp"
#include "drivers/can/transport.hpp"
#include "tests/integration/processes.hpp"
#include "tests/unit/drivers/ready_can.hpp"

namespace odomcalib::test_support {
namespace {

using drivers::ControllerState;

constexpr double kSpeed_rad_s = 4.0;
constexpr int kCounts = 16384;

class CanopenPeer : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(setenv("NODE_PATH", ODOMCALIB_PEER_MODULES, 1), 0);
    std::string name = "/tmp/odomcalib-peer-XXXXXX";
    folder_ = mkdtemp(name.data());
    master_ = posix_openpt(O_RDWR | O_NOCTTY);  // blocks, is inherited: the peer's thread waits in it
    ASSERT_EQ(grantpt(master_) + unlockpt(master_), 0);
    peer_ = std::make_unique<Process>(
        std::vector<std::string>{ODOMCALIB_NODE, ODOMCALIB_PEER_SCRIPT, std::to_string(master_)},
        folder_ / "peer.log");
    ASSERT_TRUE(wait_until([this] { return told("ready"); }, 20.0)) << log();
    auto bus = drivers::test::open_ready_can("slcan:" + std::string(ptsname(master_)) + "?bitrate=500000");
    ASSERT_TRUE(bus.ok()) << bus.error().text() << log();
    bus_ = std::move(bus).value();
    auto controller = drivers::make_controller(ODOMCALIB_PEER_PROFILE);
    ASSERT_TRUE(controller.ok()) << controller.error().text();
    controller_ = std::move(controller).value();
  }
  void TearDown() override {
    peer_.reset();
    bus_.reset();
    close(master_);
    std::filesystem::remove_all(folder_);
  }

  void turn() {
    pollfd polled{bus_->fd(), POLLIN, 0};
    poll(&polled, 1, 2);
    const auto frames = bus_->receive(monotonic());
    ASSERT_TRUE(frames.ok()) << frames.error().text();
    for (const auto& frame : frames.value()) controller_->on_frame(frame);
    controller_->on_time(monotonic());
    for (const auto& frame : controller_->take_frames()) ASSERT_TRUE(bus_->send(frame).ok());
    for (const auto& event : controller_->take_events()) events_ += event.code + ": " + event.text + "\n";
  }
  template <typename Condition>
  bool turn_until(Condition condition, double seconds = 10.0) {
    for (const double end = monotonic() + seconds; monotonic() < end && !HasFatalFailure();) {
      turn();
      if (condition()) return true;
    }
    return false;
  }
  void turn_for(double seconds) {
    (void)turn_until([] { return false; }, seconds);
  }
  /// Configured, and for a while at rest.
  bool set_up() {
    const bool ready = turn_until([this] { return controller_->state() == ControllerState::disabled; });
    turn_for(0.3);
    return ready;
  }
  std::string log() const {
    std::ifstream file(folder_ / "peer.log");
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Whether the peer told a line that begins like this.
  bool told(const std::string& line) const { return ("\n" + log()).find("\n" + line) != std::string::npos; }
  bool happened(const std::string& code) const { return events_.find(code + ":") != std::string::npos; }
  drivers::ParameterJobResult job_result() {
    std::optional<drivers::ParameterJobResult> result;
    EXPECT_TRUE(turn_until([&] { return (result = controller_->take_job_result()).has_value(); })) << events_;
    return result.value_or(drivers::ParameterJobResult{});
  }

  std::filesystem::path folder_;
  int master_ = -1;
  std::unique_ptr<Process> peer_;
  std::unique_ptr<drivers::CanTransport> bus_;
  std::unique_ptr<drivers::Controller> controller_;
  std::string events_;
};

TEST_F(CanopenPeer, is_identified_configured_and_started) {
  ASSERT_TRUE(set_up()) << events_ << log();
  const auto identity = controller_->identity();
  ASSERT_TRUE(identity.has_value());
  EXPECT_EQ(identity->vendor, 0x0FEEU);
  EXPECT_EQ(identity->product, 0x0CA7U);
  EXPECT_EQ(identity->revision, 7U);
  EXPECT_EQ(identity->serial, 60201U);
  EXPECT_EQ(identity->name, "somebody else's stack") << "a segmented upload";
  EXPECT_TRUE(told("nmt 5")) << log();
  EXPECT_TRUE(controller_->watchdog_armed()) << events_;
}

TEST_F(CanopenPeer, and_we_hear_each_others_heartbeats_and_their_end) {
  ASSERT_TRUE(set_up()) << events_ << log();
  const auto before = controller_->counters().at("heartbeats");
  turn_for(1.0);
  EXPECT_NEAR(static_cast<double>(controller_->counters().at("heartbeats") - before), 10.0, 3.0);
  EXPECT_TRUE(told("heartbeat 127 5")) << log();
  EXPECT_FALSE(told("timeout")) << log();
  ASSERT_TRUE(wait_until([this] { return told("timeout 127"); }, 5.0))
      << "we say nothing, the peer must notice";
  peer_->tell("silence");
  EXPECT_TRUE(turn_until([this] { return controller_->state() == ControllerState::absent; }, 3.0)) << events_;
  EXPECT_TRUE(happened("heartbeat_lost") || happened("pdo_frozen")) << events_;
}

TEST_F(CanopenPeer, gives_and_takes_values_and_its_refusal_is_named) {
  ASSERT_TRUE(set_up()) << events_ << log();
  ASSERT_TRUE(controller_->start_read_parameters(monotonic()).ok());
  const auto read = job_result();
  ASSERT_FALSE(read.error) << read.error->text();
  ASSERT_EQ(read.parameters.size(), 3U);
  EXPECT_NEAR(read.parameters[2].value, 0.4, 1e-9);
  ASSERT_TRUE(controller_->start_write_parameters({{"track_width", 0.4033}}, monotonic()).ok());
  const auto written = job_result();
  ASSERT_FALSE(written.error) << written.error->text();
  ASSERT_EQ(written.parameters.size(), 1U);
  EXPECT_NEAR(written.parameters[0].value, 0.4033, 1e-9);
  ASSERT_TRUE(controller_->start_write_parameters({{"track_width", 1.5}}, monotonic()).ok());
  const auto refused = job_result();
  ASSERT_TRUE(refused.error.has_value()) << "more than the object's high limit";
  EXPECT_NE(refused.error->text().find("2100:03"), std::string::npos) << refused.error->text();
}

TEST_F(CanopenPeer, sends_emergencies_that_we_read) {
  ASSERT_TRUE(set_up()) << events_ << log();
  peer_->tell("emcy 2310");
  EXPECT_TRUE(turn_until([this] { return happened("emcy"); }, 3.0)) << events_ << log();
  EXPECT_NE(events_.find("2310"), std::string::npos) << events_;
  peer_->tell("clear");
  EXPECT_TRUE(turn_until([this] { return happened("emcy_cleared"); }, 3.0)) << events_ << log();
}

TEST_F(CanopenPeer, is_enabled_and_driven_by_process_data_and_its_counts_come_back) {
  ASSERT_TRUE(set_up()) << events_ << log();
  controller_->enable(monotonic());
  ASSERT_TRUE(turn_until([this] { return controller_->state() == ControllerState::enabled; }, 5.0))
      << events_ << log();
  (void)controller_->take_ticks();
  std::vector<TickSample> ticks;
  for (const double end = monotonic() + 2.0; monotonic() < end;) {
    ASSERT_TRUE(controller_->command(kSpeed_rad_s, -0.5 * kSpeed_rad_s, monotonic()).ok()) << events_;
    turn();
    for (const TickSample& sample : controller_->take_ticks()) ticks.push_back(sample);
  }
  ASSERT_GT(ticks.size(), 60U);
  const TickSample &first = ticks[ticks.size() / 2], &last = ticks.back();
  const double turns = (last.t - first.t) * kSpeed_rad_s / (2.0 * std::numbers::pi);
  EXPECT_NEAR(static_cast<double>(last.left - first.left), kCounts * turns, 0.05 * kCounts * turns);
  EXPECT_NEAR(static_cast<double>(last.right - first.right), -0.5 * kCounts * turns, 0.05 * kCounts * turns);
  EXPECT_TRUE(told("state 27 target 3820 -1910")) << log();  // 0.01 rpm
  controller_->quick_stop(monotonic());
  controller_->disable(monotonic());
  EXPECT_TRUE(turn_until([this] { return controller_->state() == ControllerState::disabled; }, 5.0)) << log();
}

}  // namespace
}  // namespace odomcalib::test_support
