// What may hold up a program that waits for others: a network whose queue is full, a directory of users that
// does not answer, a device that says nothing. The loop waits for none of them: each of its turns is short.
#include <gtest/gtest.h>
#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

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

}  // namespace
}  // namespace odomcalib::test_support::held_up_test
