// Attacks on a daemon by a program on the same machine, or by its disk, while its robot moves or its values
// are written: nothing of them is felt. Whole programs in real time, bounded in number and time.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/integration/processes.hpp"
#include "tests/unit/daemon/service/control_client.hpp"

namespace odomcalib::test_support::attack_test {
namespace {

using nlohmann::json;

// A turn takes less than 20 ms; what is beyond that here is other load of the machine. One that waited for
// the disk would take two seconds.
constexpr double kLongestTurn = 0.100;  // s
constexpr double kStopped = 0.250;      // s, from the stop to wheels at rest
constexpr double kAttacked = 3.0;       // s

json loop_of(const RobotAndDaemon& both) { return json::parse(both.status(), nullptr, false)["loop"]; }

class AttackedInMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
    mover_ = both_.run({"straight", "--yes", "--distance", "1.5"});
    ASSERT_TRUE(wait_until([this] { return both_.rim() > 0.15; }, 20.0)) << both_.output() << both_.status();
  }
  /// The simulated robot runs on the same two cores, and its heartbeats are to come in time.
  void attack(const std::function<void()>& once) {
    unsigned times = 0;
    for (const double end = monotonic() + kAttacked; monotonic() < end; ++times) {
      once();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::printf("%u times\n", times);
    EXPECT_GT(times, 20U);
  }
  void expect_unmoved() {
    EXPECT_GT(both_.rim(), 0.15) << both_.output();
    const json loop = loop_of(both_);
    EXPECT_LT(loop["longest_turn_in_motion"]["seconds"].get<double>(), kLongestTurn) << loop;
    const double begin = monotonic();
    ControlClient client(both_.folder() / "control");
    client.send(1, "Stop");
    const auto rest = both_.time_to_rest(begin);
    ASSERT_TRUE(rest.has_value());
    EXPECT_LE(*rest, kStopped);
  }

  RobotAndDaemon both_{3};
  std::unique_ptr<Process> mover_;
  std::mt19937 random_{7};
};

TEST_F(AttackedInMotion, by_bytes_that_are_no_calls_drives_on_and_hears_a_stop) {
  const auto noise = [this](std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random_());
    return bytes;
  };
  const std::string nested = R"({"method":")" + std::string(50'000, '[') + '\0';
  const std::string huge(3 << 20, 'x');
  const std::string wrong =
      R"({"method":"org.odomcalib.Calibration.Straight","parameters":7})" + std::string(1, '\0');
  attack([&] {
    for (const std::string& bytes : {noise(4096), nested, huge, wrong, std::string(1000, '\0')}) {
      ControlClient client(both_.folder() / "control");
      client.put(bytes);
    }
  });
  expect_unmoved();
}

TEST_F(AttackedInMotion, by_clients_that_come_and_go_drives_on_and_hears_a_stop) {
  attack([&] {
    for (int i = 0; i < 20; ++i) ControlClient client(both_.folder() / "control");
  });
  expect_unmoved();
}

TEST_F(AttackedInMotion, by_clients_that_never_read_drives_on_and_hears_a_stop) {
  std::vector<std::unique_ptr<ControlClient>> all;
  all.reserve(2);
  for (int i = 0; i < 2; ++i) all.push_back(std::make_unique<ControlClient>(both_.folder() / "control"));
  attack([&] {
    for (auto& client : all) client->send(30, "GetStatus");
    wait_until([] { return false; }, 0.05);
  });
  expect_unmoved();
}

/// While it lives, daemons that are started wait two seconds for each request to their disk.
class SlowDisk {
 public:
  SlowDisk() {
    setenv("LD_PRELOAD", ODOMCALIB_SLOW_LIBRARY, 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
  }
  ~SlowDisk() {
    unsetenv("LD_PRELOAD");
    unsetenv("ASAN_OPTIONS");
  }
  SlowDisk(const SlowDisk&) = delete;
  SlowDisk& operator=(const SlowDisk&) = delete;
};

TEST(AttackedWhileWriting, by_a_disk_that_takes_two_seconds_commits_and_the_drive_notices_nothing) {
  RobotAndDaemon both(3);
  both.daemon.reset();
  {
    const SlowDisk slow;
    both.start_daemon();
  }
  ASSERT_TRUE(wait_until([&] { return both.ready(); }, 30.0)) << both.status();
  const double begin = monotonic();
  auto writer = both.run({"params", "set", "--yes", "left_wheel_diameter=0.1512",
                          "right_wheel_diameter=0.1498", "track_width=0.4033"});
  EXPECT_EQ(writer->wait(60.0), 0) << both.output();
  EXPECT_GT(monotonic() - begin, 12.0) << "six records, two seconds each";
  const json now = json::parse(both.status(), nullptr, false);
  EXPECT_EQ(now["operator_needed"], false);
  EXPECT_EQ(now["controller"]["counters"]["emergencies"], 0) << "the drive missed our heartbeat";
  EXPECT_LT(now["loop"]["longest_turn"]["seconds"].get<double>(), kLongestTurn) << now["loop"];
}

}  // namespace
}  // namespace odomcalib::test_support::attack_test
