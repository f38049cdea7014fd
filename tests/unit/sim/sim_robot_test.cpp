// The whole simulated robot through its file descriptors, with a master written by hand.
#include "tests/sim/wires/sim_robot.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "tests/sim/effects/effect.hpp"
#include "tests/sim/wires/fault_commands.hpp"
#include "tests/sim/wires/truth_json.hpp"

namespace odomcalib::sim::sim_robot_test {
namespace {

/// One end of a wire as a program sees it.
class Port {
 public:
  explicit Port(const std::string& path)
      : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
  ~Port() { ::close(fd_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  void write(const std::string& text) const {
    EXPECT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Empty when nothing has arrived; `dead` when the port is gone.
  std::string read() {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
    dead = count == 0 || (count < 0 && errno == EIO);
    return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : "";
  }
  /// Whether there is something to read within so many milliseconds.
  [[nodiscard]] bool waits_for_bytes(int patience) const {
    pollfd request{fd_, POLLIN, 0};
    return ::poll(&request, 1, patience) > 0;
  }
  bool dead = false;

 private:
  int fd_;
};

class Robot : public testing::Test {
 protected:
  Robot() {
    SimRobotOptions options;
    options.truth = draw_truth(options.nominal, 5);
    auto made = SimRobot::create(options);
    if (!made) throw std::runtime_error(made.error().text());
    robot = std::move(made).value();
    can = std::make_unique<Port>(robot->can_path());
    lidar = std::make_unique<Port>(robot->lidar_path());
    run(0.5);
    say("C\rS6\rO\r");
    can->read();
  }

  void run(double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.01) {
      robot->step(0.01);
      received += can->read();
      lidar_bytes += lidar->read();
    }
    take_what_is_under_way();
  }
  /// Simulated time runs faster than a busy kernel carries bytes through a pseudo-terminal.
  void take_what_is_under_way() {
    constexpr int kPatience = 20;  // ms
    while (can->waits_for_bytes(kPatience) || lidar->waits_for_bytes(0)) {
      received += can->read();
      lidar_bytes += lidar->read();
      if (can->dead || lidar->dead) return;
    }
  }
  std::string say(const std::string& text) {
    can->write(text);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    received.clear();
    run(0.01);
    return received;
  }
  void enable() {
    say("t00020101\r");
    say("t60182F60600003000000\r");
    for (const char* word : {"06", "07", "0F"}) say(std::string("t2012") + word + "00\r");
  }

  std::unique_ptr<SimRobot> robot;
  std::unique_ptr<Port> can, lidar;
  std::string received, lidar_bytes;
};

TEST_F(Robot, answers_an_sdo_request_over_the_slcan_port) {
  EXPECT_NE(say("t60184018100100000000\r").find("t581843181001EE0F0000\r"), std::string::npos) << received;
  EXPECT_NE(say("t60184018100200000000\r").find("t581843181002150D0000\r"), std::string::npos) << received;
}

TEST_F(Robot, sends_lidar_packets_at_the_rate_of_the_device) {
  lidar_bytes.clear();
  run(1.0);
  EXPECT_NEAR(static_cast<double>(lidar_bytes.size()), 4486.5 / 12.0 * 47.0, 2 * 47.0);
}

TEST_F(Robot, drives_what_is_commanded_and_the_truth_follows_from_the_true_wheels) {
  enable();
  say("t3018701700007017"
      "0000\r");  // 60 rpm each: one turn a second
  run(1.0);
  const double angle = robot->body().angle()[kLeft];
  const Pose before = robot->pose();
  run(2.0);
  EXPECT_NEAR(robot->body().angle()[kLeft] - angle, 4.0 * std::numbers::pi, 1e-6);
  const double travel = std::hypot(robot->pose().x - before.x, robot->pose().y - before.y);
  const double mean = 0.5 * (robot->truth().left_diameter + robot->truth().right_diameter);
  EXPECT_NEAR(travel, 2.0 * std::numbers::pi * mean, 0.01);
  EXPECT_NE(received.find("t1818"), std::string::npos);
}

TEST_F(Robot, stops_by_itself_when_the_master_dies) {
  say("t60182B07600003000000\r");
  say("t6018231610016400"
      "7F00\r");  // node 127, 100 ms
  say("t77F105\r");
  enable();
  say("t77F105\r");
  say("t30187017000070170000\r");
  for (int i = 0; i < 20; ++i) {
    say("t77F105\r");
    run(0.04);
  }
  EXPECT_GT(robot->fastest_rim(), 0.4);
  run(0.1 + 0.15);
  EXPECT_LT(robot->fastest_rim(), 0.02);
}

TEST_F(Robot, a_cut_bus_silences_the_node_but_not_the_adapter) {
  say("t00020101\r");
  robot->cut_can(true);
  run(0.05);
  EXPECT_EQ(say("V\r"), "V0101\r");
  EXPECT_EQ(say("t60184041600000000000\r"), "\r");
  robot->cut_can(false);
  EXPECT_NE(say("t60184041600000000000\r").find("t5818"), std::string::npos);
}

TEST_F(Robot, an_unplugged_port_dies_and_a_new_one_works) {
  robot->unplug_lidar();
  run(0.02);
  EXPECT_TRUE(lidar->dead);
  ASSERT_TRUE(robot->plug_lidar().ok());
  lidar = std::make_unique<Port>(robot->lidar_path());
  lidar_bytes.clear();
  run(0.1);
  EXPECT_GT(lidar_bytes.size(), 1000U);
  robot->unplug_can();
  run(0.02);
  EXPECT_TRUE(can->dead);
}

TEST_F(Robot, nothing_is_kept_for_a_reader_that_was_not_there) {
  lidar.reset();
  robot->step(2.0);
  lidar = std::make_unique<Port>(robot->lidar_path());
  EXPECT_EQ(lidar->read(), "");
}

TEST_F(Robot, encoder_faults_show_on_the_wire_and_not_in_the_motion) {
  robot->shift_counts(0x7FFFFFFF, 0);
  EXPECT_NE(say("t60184064600100000000\r").find("t581843646001FFFFFF7F"), std::string::npos) << received;
  robot->hold_encoder(kRight, true);
  enable();
  say("t30187017000070170000\r");
  run(1.0);
  EXPECT_NE(say("t60184064600200000000\r").find("t58184364600200000000"), std::string::npos) << received;
  EXPECT_GT(std::hypot(robot->pose().x, robot->pose().y), 0.2);
}

TEST_F(Robot, obeys_faults_by_name_and_refuses_unknown_ones) {
  for (const char* line :
       {"cut can", "restore can", "abort 2100 1 06060000", "jump 5 -5", "emcy 2310", "obstacle 1 0.5",
        "hold left", "release left", "freeze lidar", "thaw lidar", "reset drive"})
    EXPECT_TRUE(apply_command(*robot, line).ok()) << line;
  for (const char* line :
       {"", "cut", "cut the cake", "emcy", "emcy 123456", "jump 1", "obstacle x y", "abort 2100"})
    EXPECT_FALSE(apply_command(*robot, line).ok()) << line;
  run(0.5);
  EXPECT_NE(say("t60182300210100A1BB0D\r").find("t58188000210100000606"), std::string::npos) << received;
}

TEST_F(Robot, foreign_frames_and_raw_bytes_reach_the_program) {
  received.clear();
  robot->inject(make_frame(0x701, {0x05}));
  robot->inject_can_bytes("sb255000\r");
  run(0.01);
  EXPECT_NE(received.find("t701105\rsb255000\r"), std::string::npos) << received;
  lidar_bytes.clear();
  robot->inject_lidar_bytes("noise");
  run(0.01);
  EXPECT_EQ(lidar_bytes.rfind("noise", 0), 0U);
}

TEST(SimRobot, an_effect_on_stamps_delays_what_arrives) {
  const auto bytes_in_first_tenth = [](const char* effect, double size) {
    SimRobotOptions options;
    Random random(1);
    options.disturbances = {find_effect(effect)->make(size, random)};
    const auto robot = SimRobot::create(options);
    Port lidar(robot.value()->lidar_path());
    robot.value()->step(0.1);
    std::size_t count = 0;  // a pseudo-terminal hands over when the machine has time
    for (int quiet = 0; quiet < 20; ++quiet) {
      const std::size_t more = lidar.read().size();
      if (more > 0) quiet = 0;
      count += more;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return count;
  };
  const auto prompt = static_cast<double>(bytes_in_first_tenth("sweep_queue", 0.0));
  const auto late = static_cast<double>(bytes_in_first_tenth("sweep_queue", 0.05));
  EXPECT_NEAR((prompt - late) / 47.0 * 12.0 / 4486.5, 0.05, 0.006);
}

TEST_F(Robot, answers_a_caller_that_waits) {
  std::string answer;
  robot->serve_during([&] {
    can->write("V\r");
    for (int i = 0; i < 2000 && answer.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      answer = can->read();
    }
  });
  EXPECT_EQ(answer.substr(0, 6), "V0101\r");
}

TEST(SimRobot, makes_stable_links_and_writes_the_truth) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("odomcalib-sim-" + std::to_string(::getpid()));
  SimRobotOptions options;
  options.truth = draw_truth(options.nominal, 9);
  options.link_dir = folder;
  const auto robot = SimRobot::create(options);
  ASSERT_TRUE(robot.ok());
  EXPECT_EQ(robot.value()->can_device(), "slcan:" + (folder / "can").string() + "?bitrate=500000");
  const auto first = std::filesystem::read_symlink(folder / "lidar");
  ASSERT_TRUE(robot.value()->plug_lidar().ok());
  EXPECT_NE(std::filesystem::read_symlink(folder / "lidar"), first);
  ASSERT_TRUE(write_truth(*robot.value(), folder / "truth.json").ok());
  EXPECT_GT(std::filesystem::file_size(folder / "truth.json"), 200U);
  std::filesystem::remove_all(folder);
}

TEST(SimRobot, says_what_to_do_when_the_can_interface_is_missing) {
  SimRobotOptions options;
  options.socketcan = "no-such-can";
  const auto robot = SimRobot::create(options);
  ASSERT_FALSE(robot.ok());
  EXPECT_EQ(robot.error().where, "no-such-can");
  EXPECT_NE(robot.error().remedy.find("vcan"), std::string::npos);
}

TEST(SimRobot, runs_much_faster_than_real_time) {
  SimRobotOptions options;
  options.truth = options.nominal;
  const auto robot = SimRobot::create(options);
  ASSERT_TRUE(robot.ok());
  Port can(robot.value()->can_path()), lidar(robot.value()->lidar_path());
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i) {
    robot.value()->step(0.01);
    can.read();
    lidar.read();
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  RecordProperty("seconds", std::to_string(took.count()));
  EXPECT_LT(took.count(), 2.5) << "10 simulated seconds";
}

}  // namespace
}  // namespace odomcalib::sim::sim_robot_test
