// How urgent the programs are: the loop alone, before whatever else the machine does, and never so that it
// leaves the processor to nobody.
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/processes.hpp"
#include "tests/unit/daemon/service/control_client.hpp"

namespace odomcalib::test_support::scheduling_test {
namespace {

using nlohmann::json;

constexpr double kLongestTurn = 0.020;  // s
constexpr int kBusy = 5;                // other programs

/// Whether this user may give programs a real-time priority: the processes of these tests then have one.
bool real_time_allowed() {
  const pid_t child = fork();
  if (child == 0) {
    const sched_param priority{.sched_priority = 10};
    _exit(sched_setscheduler(0, SCHED_RR, &priority) == 0 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Urgent : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(ODOMCALIB_SANITIZED)
    GTEST_SKIP() << "instrumented programs do not keep the times of a motion";
#endif
    if (!real_time_allowed()) GTEST_SKIP() << "NOT TESTED: no right to real-time priorities";
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  }
  [[nodiscard]] json status() const { return json::parse(both_.status(), nullptr, false); }
  [[nodiscard]] json scheduling() {
    both_.run({"--json=short", "check"})->wait(5.0);
    const json all = json::parse(both_.output(), nullptr, false);
    for (const json& one : all["checks"])
      if (one["name"] == "scheduling") return one;
    return {{"found", "no line of that name"}, {"outcome", ""}, {"remedy", ""}};
  }
  void start_anew(std::vector<std::string> command) {
    both_.daemon.reset();
    command.insert(command.end(), {ODOMCALIB_DAEMON, "--config", both_.folder() / "odomcalib.toml"});
    both_.daemon = std::make_unique<Process>(command, both_.folder() / "daemon.log");
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  }
  [[nodiscard]] bool logged(const std::string& text) const {
    return content(both_.folder() / "daemon.log").find(text) != std::string::npos;
  }

  RobotAndDaemon both_{3};
};

TEST_F(Urgent, is_the_loop_and_no_other_thread) {
  int others = 0;
  const std::filesystem::path process = "/proc/" + std::to_string(both_.daemon->id());
  for (const auto& task : std::filesystem::directory_iterator(process / "task")) {
    const pid_t thread = std::stoi(task.path().filename());
    const bool loop = thread == both_.daemon->id();
    EXPECT_EQ(sched_getscheduler(thread), loop ? SCHED_RR | SCHED_RESET_ON_FORK : SCHED_OTHER);
    others += loop ? 0 : 1;
  }
  EXPECT_GE(others, 2);
  const json found = scheduling();
  EXPECT_TRUE(found["found"].get<std::string>().starts_with("round robin, priority 10; memory")) << found;
  EXPECT_EQ(found["found"], status()["loop"]["scheduling"]);
}

TEST_F(Urgent, has_its_memory_locked_where_that_is_allowed) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: no right to lock memory";
  EXPECT_EQ(scheduling()["outcome"], "ok") << scheduling();
  const std::string memory = content("/proc/" + std::to_string(both_.daemon->id()) + "/status");
  EXPECT_NE(memory.find("VmLck:"), std::string::npos);
  EXPECT_EQ(memory.find("VmLck:\t       0 kB"), std::string::npos) << memory;
}

TEST_F(Urgent, by_nobody_is_a_service_that_says_so) {
  // Where the kernel gives no real time: containers, CONFIG_RT_GROUP_SCHED.
  start_anew({"/usr/bin/chrt", "--other", "0", "/usr/bin/prlimit", "--rtprio=0", "/usr/bin/setpriv",
              "--bounding-set=-sys_nice"});
  const json found = scheduling();
  EXPECT_EQ(found["outcome"], "warn") << found;
  EXPECT_TRUE(found["found"].get<std::string>().starts_with("no real-time priority")) << found;
  EXPECT_NE(found["remedy"].get<std::string>().find("systemctl start odomcalib"), std::string::npos) << found;
  EXPECT_TRUE(logged("not_urgent: no real-time priority"));
}

TEST_F(Urgent, by_itself_where_whoever_started_it_did_not_care) {
  start_anew({"/usr/bin/chrt", "--other", "0"});
  EXPECT_TRUE(scheduling()["found"].get<std::string>().starts_with("round robin, priority 5"))
      << scheduling();
  EXPECT_EQ(sched_getscheduler(both_.daemon->id()), SCHED_RR | SCHED_RESET_ON_FORK);
}

TEST_F(Urgent, beside_five_busy_programs_it_is_in_time) {
  start_anew({"/usr/bin/chrt", "--rr", "5"});
  std::vector<std::unique_ptr<Process>> busy;
  const std::vector<std::string> command{
      "/usr/bin/chrt", "--other", "0", "/usr/bin/setsid", "/bin/sh", "-c", "while :; do :; done"};
  busy.reserve(kBusy);
  for (int i = 0; i < kBusy; ++i)
    busy.push_back(std::make_unique<Process>(command, both_.folder() / "busy.log"));
  EXPECT_EQ(both_.run({"straight", "--yes", "--distance", "1"})->wait(30.0), 0) << both_.output();
  const json loop = status()["loop"];
  const double longest = loop["longest_turn_in_motion"]["seconds"].get<double>();
  std::printf("beside %d busy programs: longest turn %.1f ms in \"%s\"\n", kBusy, 1e3 * longest,
              loop["longest_turn_in_motion"]["part"].get<std::string>().c_str());
  EXPECT_LT(longest, kLongestTurn) << loop;
  EXPECT_EQ(loop["late_steps"], 0);
}

// Calls that take 10 ms each, for some seconds: without a rest the kernel would end the loop (LimitRTTIME).
TEST_F(Urgent, leaves_the_processor_to_others_now_and_then) {
  start_anew({"/usr/bin/prlimit", "--rttime=300000"});
  ControlClient client(both_.folder() / "control");
  const std::string call = control::encode_call({.method = std::string(control::kInterface) + ".Calibrate",
                                                 .parameters = nlohmann::ordered_json{{"dry_run", true}}});
  std::string burst;
  while (burst.size() + call.size() < 65536) burst += call;
  ASSERT_EQ(client.put(burst), burst.size());
  const double begin = monotonic();
  const std::size_t all = burst.size() / call.size();
  std::size_t answered = 0;
  EXPECT_TRUE(wait_until([&] { return (answered += client.answers().size()) == all; }, 60.0)) << answered;
  EXPECT_GT(monotonic() - begin, 1.0) << "the burst was over too soon to tell";
  EXPECT_FALSE(both_.daemon->wait(0.0).has_value()) << "ended by the kernel";
}

TEST_F(Urgent, or_not_a_service_is_not_ended_by_a_hangup) {
  both_.daemon->signal(SIGHUP);
  EXPECT_TRUE(wait_until([this] { return logged("SIGHUP changes nothing"); }, 5.0));
  EXPECT_FALSE(both_.daemon->wait(0.5).has_value()) << "it has ended";
  EXPECT_TRUE(both_.ready()) << both_.status();
}

}  // namespace
}  // namespace odomcalib::test_support::scheduling_test
