// Time of the loop that the answer to a call takes: no call, however much it asks for, holds the loop up
// while the robot stands. Processor time of the loop's own thread, so that other load does not count.
#include <ctime>

#include "tests/integration/whole_loop.hpp"

namespace odomcalib::turn_cost_test {
namespace {

// s. What the specification allows a turn; programs with sanitizers are slower.
#if defined(ODOMCALIB_SANITIZED)
constexpr double kLongestTurn = 0.400;
#else
constexpr double kLongestTurn = 0.020;
#endif
constexpr double kAnswered = 2.0, kDriven_s = 2000.0, kWritten = 60.0;  // s

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Asked {
  const char* name;
  const char* method;
  json parameters;
};

std::ostream& operator<<(std::ostream& out, const Asked& asked) { return out << asked.name; }

class TurnCost : public WholeLoop {
 protected:
  using WholeLoop::adjust;
  // Every request fits, so that it is refused for no other reason, and the lidar sees walls all around.
  void adjust(sim::SimRobotOptions& options) override { options.room = sim::box_room(16.0, 16.0, 8.0, 8.0); }
  /// The longest turn until the answer is there, s of processor time.
  double longest_turn(TestClient& caller, double answered = kAnswered) {
    double longest = 0.0;
    reply_.reset();
    for (const double end = clock_.time + answered; clock_.time < end && !reply_;) {
      robot_->step(0.002);
      clock_.time += 0.002;
      if (solving_) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (++steps_ % 10 == 0) client_->call("Renew", {{"lease", lease_}});
      const double begin = processor_time();
      service_->poll_once(0);
      longest = std::max(longest, processor_time() - begin);
      reply_ = caller.reply();
    }
    return longest;
  }

  std::optional<control::Reply> reply_;
};

class CallAtRest : public TurnCost, public testing::WithParamInterface<Asked> {};

TEST_P(CallAtRest, takes_less_than_20_ms_of_a_turn) {
  acquire();
  json parameters = GetParam().parameters;
  parameters["lease"] = lease_;
  double least = 1.0;  // of a few: what else happens on the machine only adds to it
  for (int i = 0; i < 3; ++i) {
    TestClient caller(folder_ / "control");
    caller.call(GetParam().method, parameters);
    least = std::min(least, longest_turn(caller));
    ASSERT_TRUE(reply_.has_value());
    EXPECT_EQ(reply_->error, "") << reply_->parameters;
  }
  std::printf("%.1f ms\n", 1e3 * least);
  EXPECT_LT(least, kLongestTurn);
}

class WholeMotion : public TurnCost, public testing::WithParamInterface<Asked> {};

TEST_P(WholeMotion, takes_less_than_20_ms_of_any_turn) {
  acquire();
  TestClient caller(folder_ / "control");
  json parameters = GetParam().parameters;
  parameters["lease"] = lease_;
  caller.call(GetParam().method, parameters, true);
  const double longest = longest_turn(caller, kDriven_s);
  ASSERT_TRUE(reply_.has_value());
  EXPECT_EQ(reply_->error, "") << reply_->parameters;
  std::printf("%.1f ms\n", 1e3 * longest);
  EXPECT_LT(longest, kLongestTurn);
}

// The result of a drive comes back whole, to be written into the controller.
TEST_F(TurnCost, of_a_write_back_of_a_whole_result_is_less_than_20_ms) {
  acquire();
  const json result = call("Calibrate", {{"options", {{"quick", true}}}});
  ASSERT_TRUE(result.contains("calibration"));
  for (const bool dry_run : {true, false}) {
    TestClient caller(folder_ / "control");
    caller.call("Apply", {{"lease", lease_},
                          {"calibration", result["calibration"]},
                          {"of_this_robot", true},
                          {"dry_run", dry_run}});
    const double longest = longest_turn(caller, kWritten);
    ASSERT_TRUE(reply_.has_value());
    EXPECT_EQ(reply_->error, "") << reply_->parameters;
    std::printf("%.1f ms%s\n", 1e3 * longest, dry_run ? " without writing" : "");
    EXPECT_LT(longest, kLongestTurn);
  }
}

const Asked kDriven[] = {
    {"straight", "Straight", {{"distance", 1.0}}},
    {"spin", "Spin", {{"turns", 1.0}}},
    {"spin_again_and_again", "Spin", {{"turns", 1.0}, {"repeat", 3}}},
    {"nudge", "Check", {{"nudge", true}}},
    {"calibrate", "Calibrate", {{"options", {{"quick", true}}}}},
};

INSTANTIATE_TEST_SUITE_P(Methods, WholeMotion, testing::ValuesIn(kDriven),
                         [](const auto& one) { return std::string(one.param.name); });

const Asked kAsked[] = {
    {"status", "GetStatus", json::object()},
    {"scan", "GetScan", json::object()},
    {"check", "Check", json::object()},
    {"parameters", "GetParameters", json::object()},
    {"calibrate", "Calibrate", {{"dry_run", true}}},
    {"calibrate_again_and_again", "Calibrate", {{"dry_run", true}, {"options", {{"repeat", 20}}}}},
    {"longest_straight", "Straight", {{"dry_run", true}, {"distance", 5.0}, {"speed", 0.15}, {"repeat", 20}}},
    {"slowest_straight", "Straight", {{"dry_run", true}, {"distance", 5.0}, {"speed", 0.02}, {"repeat", 3}}},
    {"longest_square",
     "Straight",
     {{"dry_run", true}, {"square", true}, {"distance", 2.0}, {"speed", 0.3}, {"repeat", 15}}},
    {"longest_spin", "Spin", {{"dry_run", true}, {"turns", 10.0}, {"rate", 1.0}, {"repeat", 8}}},
    {"slowest_spin", "Spin", {{"dry_run", true}, {"turns", 5.0}, {"rate", 0.05}, {"repeat", 1}}},
};

INSTANTIATE_TEST_SUITE_P(Methods, CallAtRest, testing::ValuesIn(kAsked),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace odomcalib::turn_cost_test
