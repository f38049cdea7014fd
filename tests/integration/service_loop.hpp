// The unmodified service against the simulated robot, through pseudo-terminals, in virtual time.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "daemon/service/service.hpp"
#include "proto/control/control.hpp"
#include "tests/sim/wires/sim_robot.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib {

using nlohmann::json;

class VirtualClock : public Clock {
 public:
  mutable double time = 100.0;
  double slept = 0.0;
  double wall_step = 0.0;  ///< s by which somebody has set the wall clock
  double each_look = 0.0;  ///< s that pass from one look at the clock to the next
  [[nodiscard]] double suspended() const override { return slept; }
  [[nodiscard]] double now() const override { return time += each_look; }
  [[nodiscard]] std::int64_t wall_us() const override {
    return static_cast<std::int64_t>(1.7e15 + (time + wall_step) * 1e6);
  }
};

// A connection to the control socket that never blocks.
class TestClient {
 public:
  explicit TestClient(const std::filesystem::path& path)
      : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~TestClient() { hang_up(); }
  TestClient(const TestClient&) = delete;
  TestClient& operator=(const TestClient&) = delete;

  void hang_up() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  void call(const std::string& method, const json& parameters, bool more = false, bool oneway = false) {
    const std::string frame = control::encode_call({.method = "org.odomcalib.Calibration." + method,
                                                    .parameters = parameters,
                                                    .oneway = oneway,
                                                    .more = more});
    ASSERT_EQ(write(fd_, frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
  }
  /// The next reply that does not continue.
  std::optional<control::Reply> reply() {
    std::array<char, 65536> buffer;
    for (ssize_t got = 0; (got = read(fd_, buffer.data(), buffer.size())) > 0;)
      decoder_.feed({buffer.data(), static_cast<std::size_t>(got)});
    while (const auto frame = decoder_.next()) {
      const auto reply = control::decode_reply(*frame);
      if (reply && !reply.value().continues) return reply.value();
      ++continued_;
    }
    return std::nullopt;
  }
  [[nodiscard]] bool connected() const { return connected_; }
  /// Replies that continue, so far.
  [[nodiscard]] int continued() const { return continued_; }

 private:
  int fd_;
  bool connected_ = false;
  int continued_ = 0;
  control::FrameDecoder decoder_;
};

class ServiceLoop : public testing::Test {
 protected:
  void SetUp() override {
    sim::SimRobotOptions options;
    options.truth = sim::draw_truth(options.nominal, 3);
    // A terminal that is gone may come back as that of a test beside this one: the service opens it by a name
    // of its own.
    options.link_dir = folder_.path();
    adjust(options);
    robot_ = value_of(sim::SimRobot::create(options));
    start_service();
    ASSERT_TRUE(service_);
    ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  }
  // Some tests set up one robot after the other.
  void TearDown() override {
    service_.reset();
    robot_.reset();
    folder_.empty();
  }

  virtual Calibrator calibrator() { return {}; }
  /// One that takes no time, virtual time or other.
  virtual std::unique_ptr<Background> disk() { return std::make_unique<Foreground>(); }
  /// Where the events of the service go.
  virtual EventLog log() { return {}; }
  virtual void adjust(sim::SimRobotOptions& /*options*/) {}
  virtual void adjust(Config& /*config*/) {}

  Config configuration() {
    Config config;
    config.controller_device = robot_->can_device();
    config.controller_profile = "drivers/base/profiles/simulated.toml";
    for (const auto& entry : std::filesystem::directory_iterator("drivers/base/profiles"))
      if (entry.path().string().find("sim") != std::string::npos)
        config.controller_profile = entry.path().string();
    config.lidar_device = robot_->lidar_device();
    config.lidar_pose = {robot_->nominal().lidar.x, robot_->nominal().lidar.y, robot_->nominal().lidar.yaw};
    config.robot.left_wheel_diameter = config.robot.right_wheel_diameter = 0.150;
    config.robot.track_width = 0.400;
    config.countdown = 0.0;
    config.lcm_enabled = false;
    config.state_dir = folder_ / "state";
    config.socket = folder_ / "control";
    adjust(config);
    return config;
  }
  void start_service() {
    service_ = value_of(Service::create(configuration(), clock_, calibrator(), disk(), log()));
  }
  /// The daemon is gone, with all that it held in its memory.
  void end_service() {
    client_.reset();
    service_.reset();
    lease_.clear();
    renewing_ = false;
  }
  void step() {
    robot_->step(0.002);
    clock_.time += 0.002;
    service_->poll_once(0);
    if (client_ && !lease_.empty() && renewing_ && ++steps_ % 10 == 0)
      client_->call("Renew", {{"lease", lease_}});
  }
  template <typename Condition>
  bool run_until(Condition condition, double seconds) {
    for (const double end = clock_.time + seconds; clock_.time < end;) {
      step();
      if (condition()) return true;
    }
    return false;
  }
  void run(double seconds) {
    run_until([] { return false; }, seconds);
  }
  json status() const { return json::parse(service_->status_json()); }
  bool ready() {
    if (++asked_ % 25 != 0) return false;
    const json now = status();
    return now["controller"]["state"] == "disabled" && now["state"] == "idle" &&
           now["robot"]["in_controller"] == true && now["lidar"]["stale"] == "" &&
           now["controller"]["stale"] == "";
  }
  /// A reply of `client` within `seconds`.
  control::Reply wait_reply(TestClient& client, double seconds) {
    std::optional<control::Reply> got;
    run_until([&] { return (got = client.reply()).has_value(); }, seconds);
    EXPECT_TRUE(got.has_value()) << "no reply";
    return got.value_or(control::Reply{});
  }
  /// Answer to somebody who asks this and nothing else.
  control::Reply ask(const std::string& method, const json& parameters, double seconds) {
    TestClient caller(folder_ / "control");
    caller.call(method, parameters);
    return wait_reply(caller, seconds);
  }
  void acquire() {
    client_ = std::make_unique<TestClient>(folder_ / "control");
    client_->call("Acquire", json::object());
    lease_ = json::parse(wait_reply(*client_, 1.0).parameters).value("lease", "");
    ASSERT_FALSE(lease_.empty());
    renewing_ = true;
  }
  void start_straight(TestClient& mover) {
    mover.call("Straight", {{"lease", lease_}, {"distance", 1.0}}, true);
    ASSERT_TRUE(run_until([this] { return robot_->fastest_rim() > 0.15; }, 8.0)) << service_->status_json();
  }
  /// A client whose straight line has begun.
  struct Mover : TestClient {
    explicit Mover(ServiceLoop& loop) : TestClient(loop.folder_ / "control") { loop.start_straight(*this); }
  };
  /// Time until the simulated wheels have come down to a creep.
  double time_to_rest() {
    const double begin = clock_.time;
    run_until([this] { return robot_->fastest_rim() < 0.01; }, 3.0);
    return clock_.time - begin;
  }

  TemporaryFolder folder_;
  VirtualClock clock_;
  std::unique_ptr<sim::SimRobot> robot_;
  std::unique_ptr<Service> service_;
  std::unique_ptr<TestClient> client_;
  std::string lease_;
  bool renewing_ = false;
  int steps_ = 0, asked_ = 0;
};

}  // namespace odomcalib
