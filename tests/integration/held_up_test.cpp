// Delays of a program that waits for others: a network whose queue is full, a directory of users that does
// not answer, a device that says nothing. The loop waits for none of them: each of its turns is short.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/call_watch.hpp"
#include "tests/integration/processes.hpp"

namespace odomcalib::test_support::held_up_test {
namespace {

using nlohmann::json;

constexpr double kLongestTurn = 0.020;  // s

std::string text_in(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool shell(const std::string& command) {
  return system(("PATH=$PATH:/usr/sbin:/sbin; " + command).c_str()) == 0;
}

/// A network of this process alone, and of what it starts.
bool own_network() {
  if (unshare(CLONE_NEWNET) == 0) return true;
  const uid_t user = getuid();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
  return geteuid() == 0;
}

class HeldUp : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(ODOMCALIB_SANITIZED)
    GTEST_SKIP() << "instrumented programs do not keep the times of a motion";
#endif
  }
  void start_anew(const std::string& configured, const std::string& instead) {
    both_.daemon.reset();
    std::string text = text_in(both_.folder() / "odomcalib.toml");
    text.replace(text.find(configured), configured.size(), instead);
    std::ofstream(both_.folder() / "odomcalib.toml") << text;
    both_.start_daemon();
  }
  [[nodiscard]] json status() const { return json::parse(both_.status(), nullptr, false); }
  void expect_short_turns() const {
    const json loop = status()["loop"];
    for (const char* which : {"longest_turn", "longest_turn_in_motion"}) {
      const double longest = loop[which]["seconds"].get<double>();
      std::printf("%s %.1f ms in \"%s\"\n", which, 1e3 * longest,
                  loop[which]["part"].get<std::string>().c_str());
      EXPECT_LT(longest, kLongestTurn) << loop;
    }
    EXPECT_EQ(loop["late_steps"], 0);
  }
  void drive() {
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
    EXPECT_EQ(both_.run({"straight", "--yes", "--distance", "1"})->wait(30.0), 0) << both_.output();
  }

  /// Checks the answer to somebody who may not use the socket, and who has to be judged first. Root alone can
  /// be somebody else.
  void expect_a_stranger_is_refused() {
    if (geteuid() != 0) return;
    std::filesystem::permissions(both_.folder(), std::filesystem::perms::all);
    std::filesystem::permissions(both_.folder() / "control", std::filesystem::perms::all);
    Process other({"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", ODOMCALIB_CTL,
                   "--socket", both_.folder() / "control", "status"},
                  both_.folder() / "other");
    EXPECT_EQ(other.wait(10.0), 11) << text_in(both_.folder() / "other");
  }

  RobotAndDaemon both_{3};
};

struct Rate {
  const char* rate;
  bool overrun;  ///< by what the daemon sends
};

std::ostream& operator<<(std::ostream& out, const Rate& one) { return out << one.rate; }

class SlowNetwork : public HeldUp, public ::testing::WithParamInterface<Rate> {};

TEST_P(SlowNetwork, holds_up_no_turn) {
  if (!own_network()) GTEST_SKIP() << "NOT TESTED: no right to a network namespace";
  const std::string queue =
      std::string("tc qdisc add dev out root tbf burst 1600 limit 1000000 rate ") + GetParam().rate;
  if (!shell("ip link add out type veth peer name in && ip link set in up && ip link set out up && "
             "ip address add 10.77.0.1/24 dev out && ip route add 224.0.0.0/4 dev out && " +
             queue))
    GTEST_SKIP() << "NOT TESTED: iproute2, veth or the tbf queue is missing";
  start_anew("enabled = false", "url = \"udpm://239.255.76.67:7667?ttl=1\"");
  drive();
  EXPECT_GT(status()["lcm"]["sent"], 50);
  EXPECT_EQ(status()["lcm"]["failed"], 0);
  expect_short_turns();
  if (!GetParam().overrun) return;
  EXPECT_TRUE(wait_until([this] { return status()["lcm"].value("dropped", 0) > 0; }, 20.0)) << both_.status();
  EXPECT_EQ(both_.run({"status"})->wait(5.0), 0);
  EXPECT_NE(both_.output().find("dropped: the network is too slow"), std::string::npos) << both_.output();
  const double begin = monotonic();
  both_.daemon->signal(SIGTERM);
  EXPECT_EQ(both_.daemon->wait(5.0), 0);
  EXPECT_LT(monotonic() - begin, 2.0) << "its end waited for the network";
}

INSTANTIATE_TEST_SUITE_P(Processes, SlowNetwork,
                         ::testing::Values(Rate{"64kbit", true}, Rate{"400kbit", false}));

/// While it lives, daemons that are started ask a directory of users that takes two seconds for each
/// question.
class SlowDirectory {
 public:
  SlowDirectory() {
    setenv("LD_PRELOAD", ODOMCALIB_SLOW_DIRECTORY, 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
  }
  ~SlowDirectory() {
    unsetenv("LD_PRELOAD");
    unsetenv("ASAN_OPTIONS");
  }
  SlowDirectory(const SlowDirectory&) = delete;
  SlowDirectory& operator=(const SlowDirectory&) = delete;
};

TEST_F(HeldUp, by_a_directory_of_users_for_no_turn) {
  {
    const SlowDirectory slow;
    start_anew("[daemon]", "[daemon]\ngroup = \"daemon\"");
  }
  ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 30.0)) << both_.status();
  expect_a_stranger_is_refused();
  drive();
  expect_short_turns();
}

TEST_F(HeldUp, by_an_adapter_that_is_replugged_while_it_records_for_no_turn) {
  ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  auto recording = both_.run({"record", "--duration", "6"});
  for (int i = 0; i < 2; ++i) {
    both_.robot->tell("unplug can");
    ASSERT_TRUE(wait_until([this] { return status()["controller"]["connected"] == false; }, 5.0));
    both_.robot->tell("plug can");
    ASSERT_TRUE(wait_until([&] { return status()["controller"]["counters"]["reconnects"] == i + 1; }, 5.0))
        << both_.status();
  }
  EXPECT_EQ(recording->wait(15.0), 0) << both_.output();
  expect_short_turns();
}

TEST_F(HeldUp, by_an_adapter_that_answers_nothing_for_no_turn) {
  both_.daemon.reset();
  const int silent = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(grantpt(silent) + unlockpt(silent), 0);
  start_anew((both_.folder() / "ports" / "can").string(), ptsname(silent));
  ASSERT_TRUE(wait_until(
      [this] {
        const json now = status();
        return now.is_object() && now["controller"]["connected"] == true &&
               now["controller"]["counters"].value("unacknowledged", 0) == 1;
      },
      10.0))
      << both_.status();
  expect_short_turns();
  close(silent);
}

/// systemd, or what takes its messages, does not read them.
TEST_F(HeldUp, by_a_service_manager_that_is_busy_for_no_turn) {
  const int manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (both_.folder() / "notify").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(bind(manager, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  setenv("NOTIFY_SOCKET", address.sun_path, 1);
  setenv("WATCHDOG_USEC", "4000", 1);  // an inbox of 512 is full in a second or two
  start_anew("[daemon]", "[daemon]");
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  drive();
  expect_short_turns();
  close(manager);
}

/// Everything that the service does with devices, clients, the disk and the network, under the kernel's eyes.
TEST_F(HeldUp, by_no_call_that_may_wait) {
  if (!own_network() || !shell("ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo"))
    std::printf("LCM IS NOT WATCHED: no right to a network namespace\n");
  start_anew("enabled = false", "enabled = true");
  both_.daemon.reset();
  for (const char* port : {"can", "lidar"}) both_.robot->tell(std::string("unplug ") + port);
  CallWatch watch({ODOMCALIB_DAEMON, "--config", both_.folder() / "odomcalib.toml"},
                  both_.folder() / "daemon.log");
  if (!watch.unable().empty()) GTEST_SKIP() << "NOT TESTED: " << watch.unable();
  ASSERT_TRUE(wait_until([this] { return !both_.status().empty(); }, 20.0))
      << text_in(both_.folder() / "daemon.log");
  watch.begin();
  for (const char* port : {"can", "lidar"}) both_.robot->tell(std::string("plug ") + port);
  drive();
  EXPECT_EQ(both_.run({"record", "--duration", "0.5"})->wait(10.0), 0) << both_.output();
  EXPECT_EQ(both_.run({"params", "set", "--yes", "track_width=0.401"})->wait(20.0), 0) << both_.output();
  EXPECT_EQ(both_.run({"check"})->wait(10.0), 0) << both_.output();
  expect_a_stranger_is_refused();
  EXPECT_EQ(both_.run({"history"})->wait(10.0), 0) << both_.output();
  both_.robot->tell("unplug can");
  EXPECT_TRUE(wait_until([this] { return status()["controller"]["connected"] == false; }, 5.0));
  watch.end();
  EXPECT_GT(watch.looked_at(), 1000U);
  EXPECT_GT(status()["lcm"]["sent"].get<int>() + status()["lcm"]["failed"].get<int>(), 0);
  EXPECT_THAT(watch.waits(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace odomcalib::test_support::held_up_test
