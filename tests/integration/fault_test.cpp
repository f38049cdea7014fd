// Faults in mid-motion, one by one: each ends in a named state within a stated time, and nothing restarts by
// itself. Virtual time, the unmodified service, the simulated robot behind its wires. F-numbers:
// docs/evidence/faults.md.
#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/integration/fault_loop.hpp"
#include "tests/integration/stopping_faults.hpp"

namespace odomcalib::fault_test {
namespace {

using sim::make_frame;
using sim::SimRobot;

class StoppingFault : public FaultLoop, public testing::WithParamInterface<Fault> {};

TEST_P(StoppingFault, ends_in_a_named_state_in_time_and_nothing_restarts) {
  acquire();
  Mover mover(*this);
  GetParam().begin(*robot_);
  const double zero = time_to_zero(3.0);
  const double rest = zero + time_to_rest();
  const json end = end_of(mover, 1.0);
  const std::string said = status()["last_stop"];
  std::printf("%s: told to stop after %.0f ms, at rest after %.0f ms, \"%s\"\n", GetParam().name, 1e3 * zero,
              1e3 * rest, said.c_str());
  EXPECT_LE(zero, GetParam().limit);
  EXPECT_TRUE(stopped(end)) << end;
  EXPECT_NE(said.find(GetParam().said), std::string::npos) << said;
  GetParam().end(*robot_);
  expect_no_restart(1.0);
  EXPECT_TRUE(run_until([this] { return usable(GetParam().state); }, GetParam().ready))
      << service_->status_json();
  start_straight(mover);  // by hand
}

INSTANTIATE_TEST_SUITE_P(Faults, StoppingFault, testing::ValuesIn(stopping_faults()),
                         [](const auto& one) { return std::string(one.param.name); });

// Faults present from the start show in motion only: odometry and lidar must agree after 0.2 m or 30 degrees.
struct Deceit {
  const char* name;
  void (*begin)(SimRobot& robot);
  const char* method;
  const char* said = "lidar";  ///< part of the reason that is reported
  double lidar_yaw = 0.0;
};

std::ostream& operator<<(std::ostream& out, const Deceit& deceit) { return out << deceit.name; }

class DeceivingFault : public FaultLoop, public testing::WithParamInterface<Deceit> {
 protected:
  using FaultLoop::adjust;
  void adjust(Config& config) override { config.lidar_pose[2] += GetParam().lidar_yaw; }
};

TEST_P(DeceivingFault, is_found_by_the_lidar_before_half_a_metre_or_a_third_of_a_turn) {
  GetParam().begin(*robot_);
  run(1.0);
  acquire();
  TestClient mover(folder_ / "control");
  const char* const how_far = std::string_view(GetParam().method) == "Spin" ? "turns" : "distance";
  mover.call(GetParam().method, {{"lease", lease_}, {how_far, 1.0}}, true);
  double distance = 0.0, turn = 0.0, last = robot_->pose().yaw;
  std::optional<control::Reply> got;
  run_until(
      [&] {
        distance = std::max(distance, std::hypot(robot_->pose().x, robot_->pose().y));
        turn += robot_->pose().yaw - last;
        last = robot_->pose().yaw;
        return (got = mover.reply()).has_value();
      },
      60.0);
  const std::string said = status()["last_stop"];
  std::printf("%s: stopped after %.2f m, %.0f deg, \"%s\"\n", GetParam().name, distance,
              turn * 180.0 / std::numbers::pi, said.c_str());
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->error, "org.odomcalib.Calibration.ProtectiveStop") << got->parameters;
  EXPECT_NE(said.find(GetParam().said), std::string::npos) << said;
  EXPECT_LT(distance, 0.75);
  EXPECT_LT(std::abs(turn), 2.1);
  expect_no_restart(1.0);
}

const Deceit kDeceiving[] = {
    {"F19_left_sign_inverted", [](SimRobot& r) { r.scale_encoder(sim::kLeft, -1.0); }, "Straight", "rad/s"},
    {"F19_right_sign_inverted", [](SimRobot& r) { r.scale_encoder(sim::kRight, -1.0); }, "Straight", "rad/s"},
    {"F19_both_signs_inverted",
     [](SimRobot& r) {
       r.scale_encoder(sim::kLeft, -1.0);
       r.scale_encoder(sim::kRight, -1.0);
     },
     "Straight"},
    {"F20_left_and_right_swapped", [](SimRobot& r) { r.node().faults.swap_sides = true; }, "Spin"},
    {"F21_ticks_per_turn_half_of_the_truth",
     [](SimRobot& r) {
       r.scale_encoder(sim::kLeft, 2.0);
       r.scale_encoder(sim::kRight, 2.0);
     },
     "Straight", "m/s"},
    {"F21_ticks_per_turn_twice_the_truth",
     [](SimRobot& r) {
       r.scale_encoder(sim::kLeft, 0.5);
       r.scale_encoder(sim::kRight, 0.5);
     },
     "Straight"},
    {"F28_lidar_turned_by_180_degrees", [](SimRobot& /*r*/) {}, "Straight", "lidar", std::numbers::pi},
    {"F28_lidar_turned_by_90_degrees", [](SimRobot& /*r*/) {}, "Straight", "lidar", 0.5 * std::numbers::pi},
    {"F28_lidar_upside_down", [](SimRobot& r) { r.lidar_faults().mirrored = true; }, "Spin"},
};

INSTANTIATE_TEST_SUITE_P(Faults, DeceivingFault, testing::ValuesIn(kDeceiving),
                         [](const auto& one) { return std::string(one.param.name); });

// Faults that must not stop a motion: it comes to its end, and the odometry is right.
class BearableFault : public FaultLoop {
 protected:
  /// Metres between where the odometry and where the truth says that the robot is after 0.6 m out and back.
  json drive(const std::function<void()>& in_motion) {
    acquire();
    TestClient mover(folder_ / "control");
    mover.call("Straight", {{"lease", lease_}, {"distance", 0.6}}, true);
    std::optional<control::Reply> got;
    run_until(
        [&] {
          if (robot_->fastest_rim() > 0.05) in_motion();
          return (got = mover.reply()).has_value();
        },
        60.0);
    EXPECT_TRUE(got.has_value());
    EXPECT_EQ(got ? got->error : "", "") << service_->status_json();
    return got ? json::parse(got->parameters).value("result", json::object()) : json::object();
  }
  void expect_odometry_holds() {
    const auto told = status()["odometry"];
    EXPECT_NEAR(told[0].get<double>(), robot_->pose().x, 0.03);
    EXPECT_NEAR(told[1].get<double>(), robot_->pose().y, 0.03);
  }
};

TEST_F(BearableFault, F4_full_bus_load_of_foreign_frames) {
  std::uint64_t injected = 0;
  drive([&] {
    for (int i = 0; i < 8; ++i, ++injected)  // in 2 ms: 4000 frames/s, 500 kbit/s with 8 bytes
      robot_->inject(make_frame(0x3A5, {1, 2, 3, 4, 5, 6, 7, 8}));
  });
  EXPECT_GT(injected, 10'000U);
  expect_odometry_holds();
}

TEST_F(BearableFault, F14_reordered_process_data) {
  robot_->node().faults.pdo_reordered = true;
  drive([] {});
  robot_->node().faults.pdo_reordered = false;
  run(0.5);
  expect_odometry_holds();
}

TEST_F(BearableFault, F16_counts_wrap_at_32_bits) {
  robot_->shift_counts(std::int64_t{0x7FFFFFFF} - 2000, -std::int64_t{0x7FFFFFFF} + 2000);
  run(1.0);
  ASSERT_TRUE(run_until([this] { return ready(); }, 5.0));
  const json before = status();
  EXPECT_GT(before["controller"]["counters"]["tick_jumps"], 0) << "the counters were never near their end";
  drive([] {});
  EXPECT_EQ(status()["controller"]["counters"]["tick_jumps"], before["controller"]["counters"]["tick_jumps"]);
  expect_odometry_holds();
}

TEST_F(BearableFault, F27_restart_of_the_clock_of_the_lidar_ends_the_motion_or_leaves_it_whole) {
  acquire();
  Mover mover(*this);
  robot_->reset_lidar();
  const json end = end_of(mover, 60.0);
  EXPECT_TRUE(stopped(end) || end["error"] == "") << end;
  EXPECT_TRUE(run_until([this] { return ready(); }, 3.0)) << service_->status_json();
}

// A person beside the way, there and gone again and again, is neither an obstacle nor a reason to disagree.
TEST_F(BearableFault, F29_somebody_walks_about_beside_the_way) {
  const sim::Room empty = robot_->room();
  int turn = 0;
  drive([&] {
    if (++turn % 50 != 0) return;
    robot_->room() = empty;
    robot_->room().add_pillar({1.2 - 0.1 * (turn / 50 % 24), 1.1}, 0.15);
  });
  EXPECT_GT(turn, 500);
  expect_odometry_holds();
}

class InCorridor : public BearableFault {
 protected:
  using BearableFault::adjust;
  void adjust(sim::SimRobotOptions& options) override {
    BearableFault::adjust(options);
    options.room = sim::corridor();
  }
};

TEST_F(InCorridor, F31_a_motion_that_the_lidar_cannot_judge_ends_after_a_third_of_a_metre) {
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 1.0}}, true);
  const json end = end_of(mover, 30.0);
  EXPECT_EQ(end["error"], "org.odomcalib.Calibration.ProtectiveStop") << end;
  EXPECT_NE(end["parameters"]["what"].get<std::string>().find("cannot judge"), std::string::npos) << end;
  run(0.5);
  EXPECT_GT(robot_->pose().x, 0.25);
  EXPECT_LT(robot_->pose().x, 0.45);
}

class ShortSighted : public BearableFault {
 protected:
  using BearableFault::adjust;
  void adjust(sim::SimRobotOptions& options) override {
    BearableFault::adjust(options);
    options.lidar.range_max = 3.0;
  }
};

// Glass, black cloth, sunlight: few beams come back, none from ahead. What is driven is driven, nothing is
// claimed.
TEST_F(ShortSighted, F30_few_near_readings_claim_nothing_wrong) {
  run(2.0);  // what so few readings give depends on the moment (docs/evidence/faults.md)
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 0.6}}, true);
  const json end = end_of(mover, 60.0);
  if (end["error"] != "") {
    EXPECT_NE(end["parameters"]["what"].get<std::string>().find("cannot judge"), std::string::npos) << end;
    return;
  }
  for (const auto& move : end["parameters"]["result"]["moves"]) {
    if (move["lidar"].is_null()) continue;
    EXPECT_LT(std::abs(move["error"]["distance"].get<double>()), 0.03) << move;
  }
}

// Faults of the parameter channel: nothing moves, old values stay, the cause is named.
class ParameterFault : public FaultLoop {
 protected:
  control::Reply write_track() {
    acquire();
    TestClient writer(folder_ / "control");
    writer.call("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}});
    return wait_reply(writer, 30.0);
  }
  void expect_old_values() {
    EXPECT_EQ(robot_->node().geometry_in_ram()[2], 400000U);
    EXPECT_EQ(robot_->node().geometry_stored()[2], 400000U);
  }
};

TEST_F(ParameterFault, F9_abort_is_named_and_old_values_stay) {
  robot_->node().sdo_faults().abort_on_write[{0x2100, 3}] = 0x06060000;
  const auto reply = write_track();
  EXPECT_NE(reply.error, "");
  EXPECT_NE(reply.parameters.find("2100:03"), std::string::npos) << reply.parameters;
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.WriteFailed");
  expect_old_values();
}

TEST_F(ParameterFault, F10_silence_is_a_time_out_and_old_values_stay) {
  robot_->node().sdo_faults().silent = true;
  const double begin = clock_.time;
  const auto reply = write_track();
  std::printf("F10: told after %.1f s: %s\n", clock_.time - begin, reply.error.c_str());
  EXPECT_NE(reply.error, "");
  EXPECT_LT(clock_.time - begin, 10.0);
  expect_old_values();
}

TEST_F(ParameterFault, F11_answers_for_another_object_are_counted_and_not_believed) {
  acquire();
  TestClient writer(folder_ / "control");
  writer.call("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}});
  std::optional<control::Reply> got;
  int turn = 0;
  run_until(
      [&] {
        if (++turn % 5 == 0) robot_->inject(make_frame(0x581, {0x43, 0x00, 0x22, 0x01, 1, 2, 3, 4}));
        return (got = writer.reply()).has_value();
      },
      30.0);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->error, "") << got->parameters;
  EXPECT_EQ(robot_->node().geometry_stored(), (std::array<std::uint32_t, 3>{150000, 150000, 403300}));
  EXPECT_GT(status()["controller"]["counters"]["sdo_unexpected"], 0);
}

}  // namespace
}  // namespace odomcalib::fault_test
