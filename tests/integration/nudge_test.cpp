// check --nudge through the wires: each wire of the simulated robot in the wrong place is named before
// anything is fitted.
#include <cmath>
#include <numbers>
#include <set>

#include "tests/integration/service_loop.hpp"
#include "tests/sim/wires/fault_commands.hpp"

namespace odomcalib::nudge_test {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

struct Miswired {
  const char* name;
  std::vector<const char*> commands;            ///< of tests/sim/README.md
  std::vector<std::set<std::string>> expected;  ///< explanations, in any order; none: all is well
  double configured_yaw = 0.0;                  ///< rad, while the lidar looks ahead
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
void PrintTo(const Miswired& one, std::ostream* out) { *out << one.name; }

class Nudged : public ServiceLoop {
 protected:
  using ServiceLoop::adjust;
  Calibrator calibrator() override { return make_calibrator(); }

  json nudge() {
    acquire();
    TestClient mover(folder_ / "control");
    mover.call("Check", {{"lease", lease_}, {"nudge", true}}, true);
    std::optional<control::Reply> got;
    run_until(
        [&] {
          farthest_ = std::max(farthest_, std::hypot(robot_->pose().x, robot_->pose().y));
          return (got = mover.reply()).has_value();
        },
        60.0);
    EXPECT_TRUE(got && got->error.empty()) << (got ? got->parameters : "no reply");
    return got ? json::parse(got->parameters).value("result", json::object()) : json::object();
  }
  static std::vector<std::set<std::string>> explanations(const json& result) {
    std::vector<std::set<std::string>> all;
    for (const auto& one : result["wiring"]["explanations"]) {
      std::set<std::string> names;
      for (const auto& fault : one) names.insert(fault["name"].get<std::string>());
      all.push_back(names);
    }
    return all;
  }
  double farthest_ = 0.0;
};

class NudgedMiswired : public Nudged, public testing::WithParamInterface<Miswired> {
 protected:
  using Nudged::adjust;
  void adjust(Config& config) override { config.lidar_pose[2] += GetParam().configured_yaw; }
};

TEST_P(NudgedMiswired, is_named_and_the_robot_has_hardly_moved) {
  for (const char* command : GetParam().commands) ASSERT_TRUE(sim::apply_command(*robot_, command).ok());
  run(1.0);
  const json result = nudge();
  ASSERT_TRUE(result.contains("wiring")) << result;
  auto found = explanations(result);
  auto expected = GetParam().expected;
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found, expected) << result["wiring"];
  EXPECT_EQ(result["wiring"]["outcome"], expected.empty() ? "ok" : "fail");
  EXPECT_LT(farthest_, 0.08);
  run(0.5);
  EXPECT_LT(robot_->fastest_rim(), 1e-3);
  EXPECT_EQ(status()["controller"]["state"], "disabled");
}

const Miswired kMiswired[] = {
    {"nothing", {}, {}},
    {"counts_exchanged", {"swap counts"}, {{"counts_exchanged"}}},
    {"motors_exchanged", {"swap motors"}, {{"motors_exchanged"}}},
    {"sides_exchanged", {"swap counts", "swap motors"}, {{"sides_exchanged"}, {"lidar_mirrored"}}},
    {"left_counts_inverted", {"invert left counts"}, {{"left_counts_inverted"}}},
    {"right_counts_inverted", {"invert right counts"}, {{"right_counts_inverted"}}},
    {"left_motor_inverted", {"invert left motor"}, {{"left_motor_inverted"}}},
    {"right_motor_inverted", {"invert right motor"}, {{"right_motor_inverted"}}},
    {"left_wheel_inverted", {"invert left motor", "invert left counts"}, {{"left_wheel_inverted"}}},
    {"lidar_upside_down", {"mirror lidar"}, {{"sides_exchanged"}, {"lidar_mirrored"}}},
    {"lidar_turned_by_90", {}, {{"lidar_yaw"}}, kQuarter},
    {"lidar_turned_by_180", {}, {{"lidar_yaw"}}, 2.0 * kQuarter},
    {"lidar_turned_by_minus_90", {}, {{"lidar_yaw"}}, -kQuarter},
};

INSTANTIATE_TEST_SUITE_P(Wires, NudgedMiswired, testing::ValuesIn(kMiswired),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_F(Nudged, needs_a_lease_and_leaves_the_plain_check_as_it_was) {
  TestClient asker(folder_ / "control");
  asker.call("Check", json::object());
  const json plain = json::parse(wait_reply(asker, 1.0).parameters);
  EXPECT_TRUE(plain["checks"].is_array()) << plain;
  for (const auto& check : plain["checks"]) EXPECT_NE(check["name"], "wiring");
  asker.call("Check", {{"nudge", true}});
  EXPECT_EQ(wait_reply(asker, 1.0).error, "org.odomcalib.Calibration.NotPermitted");
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
}

TEST_F(Nudged, stops_when_the_lease_lapses) {
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Check", {{"lease", lease_}, {"nudge", true}}, true);
  ASSERT_TRUE(run_until([this] { return robot_->fastest_rim() > 0.04; }, 8.0));
  renewing_ = false;
  run(0.250);
  EXPECT_LT(robot_->fastest_rim(), 0.01);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
}

}  // namespace
}  // namespace odomcalib::nudge_test
