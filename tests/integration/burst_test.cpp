// A client that sends 64 KiB of calls at once to a daemon whose robot moves: the stop at their end is obeyed
// at once, and neither the motion nor a turn of the loop suffers from the calls before it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "daemon/writeback/history.hpp"
#include "tests/integration/processes.hpp"
#include "tests/unit/daemon/service/control_client.hpp"

namespace odomcalib::test_support::burst_test {
namespace {

using nlohmann::json;

constexpr std::size_t kBurst = 65536;   // bytes of one write
constexpr double kStopped = 0.100;      // s, from the stop to the first slowing of the wheels
constexpr double kLongestTurn = 0.020;  // s
constexpr std::size_t kEffects = 60;    // of a calibration: some 20 KB of text

struct Calls {
  const char* name;
  std::string call;
};

Calls calls(const char* name, const char* parameters = "{}") {
  const std::string method = std::string(control::kInterface) + "." + name;
  return {name,
          control::encode_call({.method = method, .parameters = nlohmann::ordered_json::parse(parameters)})};
}

std::ostream& operator<<(std::ostream& out, const Calls& calls) { return out << calls.name; }

std::string as_many_as_fit(const Calls& calls, const std::string& last) {
  std::string all;
  while (all.size() + calls.call.size() + last.size() <= kBurst) all += calls.call;
  return all + last;
}

class BurstInMotion : public ::testing::TestWithParam<Calls> {
 protected:
  void SetUp() override {
#if defined(ODOMCALIB_SANITIZED)
    GTEST_SKIP() << "instrumented programs do not keep the times of a motion";
#endif
    fill_history();
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
    mover_ = both_.run({"straight", "--yes", "--distance", "1.5"});
    ASSERT_TRUE(wait_until([this] { return both_.rim() > 0.15; }, 20.0)) << both_.output() << both_.status();
  }
  void fill_history() {
    both_.daemon.reset();
    json effects = json::array();
    for (std::size_t i = 0; i < kEffects; ++i)
      effects.push_back({{"name", "effect"},
                         {"parameters", json::array({1.0 / 3.0, 2.0 / 3.0})},
                         {"evidence", std::string(200, 'x')}});
    History history(both_.folder() / "state" / "history");
    for (std::size_t i = 0; i < History::kKept; ++i) {
      HistoryEntry entry;
      entry.action = "apply";
      entry.outcome = "committed";
      entry.calibration = json{{"effects", effects}}.dump();
      entry = history.numbered(entry);
      ASSERT_TRUE(history.write(entry).ok());
      history.keep(entry);
    }
    both_.start_daemon();
  }
  [[nodiscard]] json loop() const { return json::parse(both_.status(), nullptr, false)["loop"]; }
  void expect_short_turns() const {
    const json longest = loop()["longest_turn_in_motion"];
    std::printf("longest turn %.1f ms in \"%s\"\n", 1e3 * longest["seconds"].get<double>(),
                longest["part"].get<std::string>().c_str());
    EXPECT_LT(longest["seconds"].get<double>(), kLongestTurn) << longest;
    EXPECT_EQ(loop()["late_steps"], 0);
  }

  RobotAndDaemon both_{3};
  std::unique_ptr<Process> mover_;
};

TEST_P(BurstInMotion, ends_with_a_stop_that_is_obeyed_within_100_ms) {
  ControlClient client(both_.folder() / "control");
  const double begin = monotonic();
  ASSERT_GT(client.put(as_many_as_fit(GetParam(), calls("Stop").call)), kBurst - 1024);
  const auto slower = both_.time_to_slow(begin, 0.15);
  ASSERT_TRUE(slower.has_value());
  std::printf("wheels slower after %.0f ms\n", 1e3 * *slower);
  EXPECT_LE(*slower, kStopped);
  ASSERT_TRUE(both_.time_to_rest(begin).has_value());
  expect_short_turns();
}

TEST_P(BurstInMotion, leaves_the_motion_alone) {
  ControlClient client(both_.folder() / "control");
  const std::string burst = as_many_as_fit(GetParam(), "");
  const double begin = monotonic();
  ASSERT_EQ(client.put(burst), burst.size());
  std::size_t answers = 0;
  const auto all = burst.size() / GetParam().call.size();
  EXPECT_TRUE(wait_until([&] { return (answers += client.answers().size()) == all; }, 20.0)) << answers;
  EXPECT_GT(both_.rim(), 0.15) << "the simulated robot stood still for " << both_.longest_pause(begin)
                               << " s\n"
                               << both_.output() << both_.status();
  expect_short_turns();
}

INSTANTIATE_TEST_SUITE_P(Processes, BurstInMotion,
                         ::testing::Values(calls("History"), calls("GetStatus"), calls("Check")));

// Each of these calls takes some 10 ms: the others wait, whoever else calls does not.
TEST(BurstAtRest, of_the_longest_calls_delays_other_clients_by_a_few_turns) {
  RobotAndDaemon both(3);
  ASSERT_TRUE(wait_until([&] { return both.ready(); }, 20.0)) << both.status();
  ControlClient client(both.folder() / "control");
  const Calls longest = calls("Calibrate", R"({"dry_run":true})");
  const std::string burst = as_many_as_fit(longest, "");
  ASSERT_EQ(client.put(burst), burst.size());
  double slowest = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double begin = monotonic();
    ASSERT_NE(both.status(), "");
    slowest = std::max(slowest, monotonic() - begin);
  }
  const auto answered = client.answers();
  std::printf("%zu calls served meanwhile, status after %.0f ms at most\n", answered.size(), 1e3 * slowest);
  EXPECT_LT(answered.size(), burst.size() / longest.call.size()) << "the burst was over too soon to tell";
  ASSERT_FALSE(answered.empty());
  EXPECT_EQ(answered[0].error, "") << answered[0].parameters;
  EXPECT_LT(slowest, 0.100);
}

}  // namespace
}  // namespace odomcalib::test_support::burst_test
