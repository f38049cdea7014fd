// straight and spin as a person types them: driven, proposed, applied, and the robot then measured against
// the simulator's truth. Robot and service run on one clock, faster than real time.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/integration/processes.hpp"

namespace odomcalib::test_support::lengths_test {
namespace {

using nlohmann::json;

constexpr double kSlowest = 150.0;     // s that a motion of three repetitions may take
constexpr double kTruthWritten = 0.5;  // s after which the simulator's file tells where it stands

class Lengths : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(ODOMCALIB_SANITIZED)
    GTEST_SKIP() << "instrumented programs do not keep the times of a motion";
#endif
    ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  }
  json truth() const { return json::parse(std::ifstream(both_.folder() / "truth.json")); }
  std::string file(const char* name) const { return both_.folder() / name; }
  /// Output of the command, which must succeed. The axes are off by then, as they are when a person types.
  std::string call(const std::vector<std::string>& arguments) {
    EXPECT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
    const auto client = both_.run(arguments);
    EXPECT_EQ(client->wait(kSlowest), 0) << arguments[0] << ": " << both_.output();
    return both_.output();
  }
  json call_json(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const std::string text = call(arguments);
    const auto begin = text.find('{');
    return begin == std::string::npos ? json() : json::parse(text.substr(begin), nullptr, false);
  }
  void expect_found(const json& printed, const char* name) {
    const json& found = printed["proposal"]["parameters"][name];
    const double value = found["value"], deviation = found["std"], expected = truth()["true"][name];
    std::printf("%-21s true %.6f found %.6f +- %.6f\n", name, expected, value, deviation);
    EXPECT_NEAR(value / expected, 1.0, 1e-3) << name;
    EXPECT_LT(std::abs(value - expected), 3.0 * deviation) << name;
  }
  json pose_at_rest() {
    (void)wait_until([] { return false; }, kTruthWritten, 0.1);
    return truth();
  }

  RobotAndDaemon both_{7, {}, Pace::hurried};
};

TEST_F(Lengths, S1_05_three_repetitions_applied_make_a_metre_right_to_a_millimetre) {
  const json straight = call_json({"straight", "--yes", "--repeat", "3", "--out", file("straight.json")});
  expect_found(straight, "left_wheel_diameter");
  expect_found(straight, "right_wheel_diameter");
  call({"apply", "--yes", file("straight.json")});
  const json spin = call_json({"spin", "--yes", "--repeat", "3", "--out", file("spin.json")});
  expect_found(spin, "track_width");
  call({"apply", "--yes", file("spin.json")});
  const json start = pose_at_rest()["pose"];
  const json metre = call_json({"straight", "--yes", "--one-way"});
  const json there = pose_at_rest()["pose"];
  const double way = std::hypot(there[0].get<double>() - start[0].get<double>(),
                                there[1].get<double>() - start[1].get<double>());
  EXPECT_NEAR(metre["moves"][0]["odometry"][0].get<double>(), way, 1e-3);
  const json turn = call_json({"spin", "--yes", "--direction", "ccw"});
  const double turned = pose_at_rest()["pose"][2].get<double>() - there[2].get<double>();
  const double error =
      std::remainder(turn["moves"][0]["odometry"][2].get<double>() - turned, 2.0 * std::numbers::pi);
  EXPECT_NEAR(error * 180.0 / std::numbers::pi, 0.0, 0.1);
  std::printf("a metre: %+.2f mm, a turn: %+.3f deg\n",
              1e3 * (metre["moves"][0]["odometry"][0].get<double>() - way), error * 180.0 / std::numbers::pi);
}

}  // namespace
}  // namespace odomcalib::test_support::lengths_test
