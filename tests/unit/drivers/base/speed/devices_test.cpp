// Every controller without a drive state machine, through its wire and against a device that was written from
// the manual: it is found, moves, counts, stops, and says what is wrong.
#include <cmath>
#include <numbers>

#include "drivers/base/profile/profile.hpp"
#include "drivers/base/speed/speed_protocol.hpp"
#include "tests/unit/drivers/base/bench.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::devices_test {
namespace {

using test::Bench;
using test::CanBench;
using test::SerialBench;
using test::shipped;

/// What all of them have in common: one device, one bench, figures of the profile.
struct Case {
  const char* profile;
  double counts_per_turn;
  double tolerance_turns;  ///< of the way: quantised speeds, coarse counts
  double timeout_s;        ///< the device's own
};

template <typename Device, typename Wire>
struct Rig {
  Device device;
  std::unique_ptr<Bench> bench;
  explicit Rig(const char* profile) {
    auto controller = shipped(profile);
    bench = std::make_unique<Wire>(std::move(controller), device);
  }
};

void exchange(SpeedProtocol& protocol, sim::CanDevice& device, double now) {
  for (const CanFrame& frame : protocol.take_frames())
    device.receive({frame.id, frame.extended, frame.remote, frame.length, frame.data}, now);
  for (const sim::Frame& frame : device.advance(now)) {
    CanFrame back;
    back.id = frame.id;
    back.extended = frame.extended;
    back.length = frame.length;
    back.data = frame.data;
    back.t = now;
    protocol.on_frame(back);
  }
}
void exchange(SpeedProtocol& protocol, sim::SerialDevice& device, double now) {
  const auto sent = protocol.take_bytes();
  device.receive(std::string(sent.begin(), sent.end()), now);
  const std::string back = device.advance(now);
  protocol.on_bytes({reinterpret_cast<const std::uint8_t*>(back.data()), back.size()}, now);
}

template <typename T>
class Devices : public testing::Test {};

struct AgilexRig : Rig<sim::AgilexChassis, CanBench> {
  static constexpr Case kCase{"agilex", 4096, 0.05, 0.5};
  AgilexRig() : Rig(kCase.profile) {}
};
struct VescRig : Rig<sim::VescPair, CanBench> {
  static constexpr Case kCase{"vesc", 138, 0.05, 1.0};
  VescRig() : Rig(kCase.profile) {}
};
struct ArduinoRig : Rig<sim::ArduinoBoard, SerialBench> {
  static constexpr Case kCase{"ros_arduino", 8384, 0.05, 2.0};
  ArduinoRig() : Rig(kCase.profile) {}
};
struct PioneerRig : Rig<sim::PioneerBase, SerialBench> {
  static constexpr Case kCase{"arcos", 82500, 0.1, 2.0};
  PioneerRig() : Rig(kCase.profile) {}
};

using Rigs = testing::Types<AgilexRig, VescRig, ArduinoRig, PioneerRig>;
TYPED_TEST_SUITE(Devices, Rigs);

void enable(Bench& bench) {
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
}

/// +1 or -1: a motor that is mounted mirrored turns the other way.
double mounting(const RobotDescription& robot, std::size_t side) {
  return robot.controller == "vesc" && side == 1 ? -1.0 : 1.0;
}

template <typename R>
void expect_way(R& rig, std::size_t side, double turns) {
  const double way = rig.device.wheels().angle[side] / (2.0 * std::numbers::pi);
  EXPECT_NEAR(mounting(rig.bench->controller->description(), side) * way, turns, R::kCase.tolerance_turns);
}

TYPED_TEST(Devices, is_found_moves_counts_and_stops) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  EXPECT_TRUE(bench.controller->watchdog_armed());
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  bench.drive(3.0, 3.5, 2.0);
  bench.controller->disable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.3);
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);
  for (std::size_t side = 0; side < 2; ++side)
    expect_way(rig, side, (side == 0 ? 3.0 : 3.5) * 2.0 / (2.0 * std::numbers::pi));
  ASSERT_FALSE(bench.ticks.empty());
  // The last counts are those of the device.
  const auto count = [&](std::size_t side) {
    return mounting(bench.controller->description(), side) * rig.device.wheels().angle[side] /
           (2.0 * std::numbers::pi) * TypeParam::kCase.counts_per_turn;
  };
  EXPECT_NEAR(static_cast<double>(bench.ticks.back().left), count(0), 1.5);
  EXPECT_NEAR(static_cast<double>(bench.ticks.back().right), count(1), 1.5);
  for (std::size_t i = 1; i < bench.ticks.size(); ++i) ASSERT_GT(bench.ticks[i].t, bench.ticks[i - 1].t);
  EXPECT_FALSE(bench.happened("encoder_stuck")) << bench.story();
}

TYPED_TEST(Devices, another_program_that_commands_them_stops_the_wheels) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  if (bench.controller->wire() != Wire::can) return;  // a serial line has one sender
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  ASSERT_FALSE(bench.happened("other_master")) << "its own commands";
  // What this program sends, as if somebody else had sent it.
  (void)bench.controller->command(3.0, 3.0, bench.now);
  bench.controller->on_time(bench.now += 0.05);
  const auto sent = bench.controller->take_frames();
  ASSERT_FALSE(sent.empty());
  for (CanFrame frame : sent) {
    frame.t = bench.now;
    bench.controller->on_frame(frame);
  }
  bench.run(0.01);
  EXPECT_TRUE(bench.happened("other_master"));
  EXPECT_FALSE(bench.controller->command(3.0, 3.0, bench.now).ok());
}

TYPED_TEST(Devices, a_command_that_grows_old_becomes_zero) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  EXPECT_NE(rig.device.wheels().rate[0], 0.0);
  bench.run(0.2);
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);
  EXPECT_GE(bench.controller->counters()["stale_commands"], 1U);
}

TYPED_TEST(Devices, quick_stop_stops_at_once) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  bench.controller->quick_stop(bench.now);
  bench.run(0.06);
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);
  EXPECT_FALSE(bench.controller->command(1.0, 1.0, bench.now).ok());
}

TYPED_TEST(Devices, enabled_right_after_a_stop_they_stand_before_they_follow_again) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  bench.controller->quick_stop(bench.now);
  bench.controller->enable(bench.now);
  EXPECT_EQ(bench.controller->state(), ControllerState::enabling);
  EXPECT_FALSE(bench.controller->command(3.0, 3.0, bench.now).ok());
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);
  bench.drive(3.0, 3.0, 0.5);
  EXPECT_NE(rig.device.wheels().rate[0], 0.0) << bench.story();
  EXPECT_FALSE(bench.happened("axis_not_enabled")) << bench.story();
}

// The stop guard sends what there is and may be the last to do so: nobody asks the controller again.
TYPED_TEST(Devices, a_quick_stop_is_on_its_way_before_anything_else_happens) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  rig.device.silent = true;  // an answer that is due gets lost
  bench.drive(3.0, 3.0, 0.03);
  ASSERT_NE(rig.device.wheels().rate[0], 0.0);
  bench.controller->quick_stop(bench.now);
  bench.flush();
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);
  EXPECT_EQ(rig.device.wheels().rate[1], 0.0);
}

TYPED_TEST(Devices, silence_in_motion_is_a_stop_and_the_device_is_found_again) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  bench.drive(3.0, 3.0, 0.5);
  rig.device.silent = true;
  bench.drive(3.0, 3.0, 1.0);
  EXPECT_TRUE(bench.happened("counts_lost")) << bench.story();
  EXPECT_EQ(bench.controller->state(), ControllerState::absent);
  bench.run(TypeParam::kCase.timeout_s);
  EXPECT_EQ(rig.device.wheels().rate[0], 0.0);  // the device's own watchdog
  const auto segment = bench.ticks.back().segment;
  rig.device.silent = false;
  ASSERT_TRUE(bench.run_until(ControllerState::disabled));
  bench.run(0.5);
  EXPECT_GT(bench.ticks.back().segment, segment);
}

TYPED_TEST(Devices, what_is_not_a_number_is_refused_and_stops) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_NO_FATAL_FAILURE(enable(bench));
  EXPECT_FALSE(bench.controller->command(std::nan(""), 0.0, bench.now).ok());
  bench.run(0.01);
  EXPECT_TRUE(bench.happened("bad_command"));
}

/// What a reading comes to.
ParameterJobResult read(Bench& bench) {
  EXPECT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  auto result = bench.controller->take_job_result();
  for (int i = 0; i < 2000 && !result; ++i) {
    bench.turn();
    result = bench.controller->take_job_result();
  }
  EXPECT_TRUE(result) << "it does not end";
  return result.value_or(ParameterJobResult{});
}

TYPED_TEST(Devices, geometry_stays_on_the_host_and_that_is_said) {
  TypeParam rig;
  Bench& bench = *rig.bench;
  ASSERT_TRUE(bench.run_until(ControllerState::disabled));
  for (const Capability& one : bench.controller->capabilities()) EXPECT_FALSE(one.writable) << one.quantity;
  const auto held = read(bench);
  EXPECT_TRUE(!held.error && held.parameters.empty());
  EXPECT_EQ(bench.controller->start_write_parameters({{"track_width", 0.4}}, bench.now).error().code,
            ErrorCode::refused);
}

TEST(Odrive, moves_only_when_its_watchdog_is_known_to_be_on) {
  sim::OdrivePair device;
  CanBench bench(shipped("odrive"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.controller->enable(bench.now);
  bench.run(0.5);
  EXPECT_TRUE(bench.happened("enable_refused"));
  device.silent = true;
  bench.run(1.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::absent);
}

TEST(Agilex, an_emergency_stop_is_a_fault_until_it_is_released) {
  sim::AgilexChassis device;
  CanBench bench(shipped("agilex"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled));
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  device.emergency_stop = true;
  bench.drive(2.0, 2.0, 0.3);
  EXPECT_TRUE(bench.happened("drive_fault")) << bench.story();
  ASSERT_TRUE(bench.run_until(ControllerState::fault));
  device.emergency_stop = false;
  EXPECT_TRUE(bench.run_until(ControllerState::disabled));
}

TEST(Agilex, tells_the_voltage_of_its_battery) {
  sim::AgilexChassis device;
  CanBench bench(shipped("agilex"), device);
  EXPECT_FALSE(bench.controller->supply_voltage()) << "nothing was heard yet";
  ASSERT_TRUE(bench.run_until(ControllerState::disabled));
  bench.run(0.2);  // its messages come in turns
  ASSERT_TRUE(bench.controller->supply_voltage());
  EXPECT_EQ(*bench.controller->supply_voltage(), 25.9);
}

TEST(Vesc, its_configuration_is_read_in_pieces) {
  sim::VescPair device;
  CanBench bench(shipped("vesc"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.2);
  EXPECT_GE(device.configurations_asked(), 2U);
  EXPECT_EQ(bench.controller->counters()["bad_pieces"], 0U);
  EXPECT_EQ(bench.controller->counters()["bad_packets"], 0U);
}

/// What a device of this profile says of itself in a message of this name, asked as on its wire.
template <typename Device>
std::optional<DeviceMessage> said_by(Device& device, const std::string& profile, const std::string& name) {
  const auto protocol =
      make_speed_protocol(value_of(read_profile("drivers/base/profiles/" + profile + ".toml"))).value();
  protocol->on_connected(std::nullopt);
  for (double now = 1.0; now < 5.0; now += 0.001) {
    protocol->ask(now);
    if (std::fmod(now, 0.3) < 0.001) protocol->greet(now);
    exchange(*protocol, device, now);
    for (const DeviceMessage& message : protocol->take_messages())
      if (message.name == name) return message;
  }
  return std::nullopt;
}

TEST(Vesc, says_what_it_is_set_to) {
  sim::VescPair device;
  const auto said = said_by(device, "vesc", "configuration");
  ASSERT_TRUE(said);
  EXPECT_EQ(said->number("motor_poles"), 46.0);
  EXPECT_EQ(said->number("gear_ratio"), 1.0);
  EXPECT_NEAR(said->number("wheel_diameter_m"), 0.168, 1e-6);
}

TEST(Arcos, says_what_it_is_set_to) {
  sim::PioneerBase device;
  const auto said = said_by(device, "arcos", "configuration");
  ASSERT_TRUE(said);
  EXPECT_EQ(said->number("RevCount"), 16570.0);
  EXPECT_EQ(said->number("watchdog_ms"), 2000.0);
  EXPECT_EQ(said->number("DriftFactor"), -120.0);
  EXPECT_EQ(said->number("TicksMM"), 132.0);
}

// The time that it gets begins when it is asked, however long ago the controller was looked after.
TEST(Arcos, has_its_time_to_tell_its_settings) {
  sim::PioneerBase device;
  SerialBench bench(shipped("arcos"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  device.tells_configuration = false;
  const double asked = bench.now + 0.4;
  ASSERT_TRUE(bench.controller->start_read_parameters(asked).ok());
  bench.now = asked;
  while (!bench.controller->take_job_result() && bench.now < asked + 5.0) bench.turn();
  EXPECT_NEAR(bench.now - asked, 1.0, 0.01);
}

TEST(Arcos, tells_who_it_is_and_its_watchdog) {
  sim::PioneerBase device;
  SerialBench bench(shipped("arcos"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  ASSERT_TRUE(bench.controller->identity());
  EXPECT_EQ(bench.controller->identity()->name, "Pioneer p3dx Miss Agnes SN4242");
  EXPECT_EQ(device.bad_packets(), 0U);
  test::expect_accounted(bench.controller->counters());
}

// The one thing of its settings that a motion depends on: asked for again before each.
TEST(Arcos, a_reading_asks_for_its_watchdog_again) {
  sim::PioneerBase device;
  SerialBench bench(shipped("arcos"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  EXPECT_FALSE(read(bench).error);
  device.watchdog_ms = 1500;
  const auto changed = read(bench);
  ASSERT_TRUE(changed.error);
  EXPECT_NE(changed.error->text().find("1500 ms, not 2000 ms"), std::string::npos) << changed.error->text();
  EXPECT_DOUBLE_EQ(bench.controller->watchdog_time(), 1.5);
  EXPECT_FALSE(read(bench).error) << "it is known now";
  device.tells_configuration = false;
  EXPECT_TRUE(read(bench).error);
}

/// A line that delivers everything twice.
class Echoing : public sim::ArduinoBoard {
 protected:
  void talk(double now, std::string& out) override {
    sim::ArduinoBoard::talk(now, out);
    out += out;
  }
};

TEST(RosArduino, answers_that_come_twice_are_taken_once) {
  Echoing device;
  SerialBench bench(shipped("ros_arduino"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  bench.ticks.clear();
  bench.drive(3.0, 3.0, 1.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::enabled) << bench.story();
  EXPECT_GE(bench.ticks.size(), 20U);
  const Counters counters = bench.controller->counters();
  test::expect_accounted(counters);
  EXPECT_EQ(counters.at("bad_line") + counters.at("no_answer"), 0U);
  EXPECT_GT(counters.at("unasked_line"), 20U);
}

// "OK" twice while counts are asked for, counts twice while a speed is answered.
TEST(RosArduino, a_whole_answer_of_another_kind_leaves_the_question_waiting) {
  auto controller = shipped("ros_arduino");
  const auto tell = [&](const std::string& line, double t) {
    controller->on_bytes({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, t);
  };
  controller->on_time(1.0);
  ASSERT_EQ(controller->take_bytes().size(), 2U);  // "e"
  tell("OK\r\n", 1.005);
  EXPECT_EQ(controller->counters().at("unasked_line"), 1U);
  tell("12 34\r\n", 1.010);
  EXPECT_EQ(controller->counters().at("bad_line") + controller->counters().at("no_answer"), 0U);
  EXPECT_EQ(controller->take_ticks().size(), 1U);
}

TEST(RosArduino, accounts_for_every_byte) {
  sim::ArduinoBoard device;
  SerialBench bench(shipped("ros_arduino"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(1.0);
  const Counters counters = bench.controller->counters();
  test::expect_accounted(counters);
  EXPECT_EQ(counters.at("bad_line") + counters.at("unasked_line") + counters.at("no_answer"), 0U);
  EXPECT_NEAR(static_cast<double>(bench.ticks.size()), 50.0 * (bench.now - bench.ticks.front().t), 10.0);
}

// What one question in flight must not do to a stop, and a stop not to the questions.
TEST(RosArduino, goes_on_counting_while_stops_are_repeated) {
  sim::ArduinoBoard device;
  SerialBench bench(shipped("ros_arduino"), device);
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  bench.drive(3.0, 3.0, 0.5);
  bench.ticks.clear();
  for (int i = 0; i < 50; ++i) {
    bench.controller->quick_stop(bench.now);
    bench.run(0.01);
  }
  EXPECT_GE(bench.ticks.size(), 20U);
  const Counters counters = bench.controller->counters();
  test::expect_accounted(counters);
  EXPECT_EQ(counters.at("bad_line") + counters.at("unasked_line") + counters.at("no_answer"), 0U);
}

TEST(RosArduino, an_answer_that_was_lost_before_that_of_a_stop_is_no_other_ones) {
  auto controller = shipped("ros_arduino");
  const auto tell = [&](const std::string& line, double t) {
    controller->on_bytes({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, t);
  };
  controller->on_time(1.0);
  ASSERT_EQ(controller->take_bytes().size(), 2U);  // "e", whose answer gets lost
  controller->quick_stop(1.005);
  ASSERT_EQ(controller->take_bytes().size(), 6U);
  tell("OK\r\n", 1.010);
  controller->on_time(1.020);
  const auto bytes = controller->take_bytes();
  ASSERT_GE(bytes.size(), 2U);
  EXPECT_EQ(bytes[0], 'e') << "the next question waits for nothing";
  EXPECT_EQ(controller->counters().at("no_answer"), 1U);
  EXPECT_EQ(controller->counters().at("bad_line"), 0U);
}

}  // namespace
}  // namespace odomcalib::drivers::devices_test
