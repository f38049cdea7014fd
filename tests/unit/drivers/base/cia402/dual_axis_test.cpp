// The controller against the simulated drive, frame by frame and without a clock.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>

#include "tests/unit/drivers/base/cia402/drive_bench.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::dual_axis_test {
namespace {

using namespace drive_bench;

/// A copy of a profile with one piece of text changed.
std::string changed_profile(const std::string& from, const std::string& to, const std::string& name) {
  std::string text = test::read_text("drivers/base/profiles/sim-dual.toml");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  text.replace(at, from.size(), to);
  std::string path = testing::TempDir() + std::to_string(getpid()) + name;
  std::ofstream(path) << text;
  return path;
}

TEST(DualAxis, configures_the_drive_and_gets_ticks_within_two_seconds) {
  Ready bench;
  EXPECT_LT(bench.now, 2.0);
  EXPECT_TRUE(bench.controller->watchdog_armed());
  ASSERT_TRUE(bench.controller->identity());
  EXPECT_EQ(bench.controller->identity()->vendor, 0x0FEEU);
  EXPECT_EQ(bench.controller->identity()->serial, 4242U);
  const std::size_t before = bench.ticks.size();
  bench.run(1.0);
  EXPECT_NEAR(static_cast<double>(bench.ticks.size() - before), 50.0, 3.0);
  EXPECT_TRUE(bench.events.empty());
}

TEST(DualAxis, writes_nothing_to_a_foreign_device) {
  Bench bench(changed_profile("product = 0x0D15", "product = 0x0D16", "foreign.toml"));
  bench.run(3.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::fault);
  ASSERT_NE(bench.find("identity_mismatch"), nullptr);
  for (const CanFrame& frame : bench.sent) {
    ASSERT_EQ(frame.id, 0x601U);
    EXPECT_TRUE((frame.data[0] & 0xE0) == 0x40 || (frame.data[0] & 0xE0) == 0x60) << "not a read";
  }
  bench.controller->quick_stop(bench.now);
  EXPECT_TRUE(bench.controller->take_frames().empty());
}

TEST(DualAxis, turns_both_wheels_by_what_was_commanded) {
  Enabled bench;
  const TickSample before = bench.ticks.back();
  bench.drive(2.0, -1.0, 2.0);
  const TickSample after = bench.ticks.back();
  const double seconds = after.t - before.t;
  EXPECT_NEAR(static_cast<double>(after.left - before.left), 2.0 * kTicksPerRad * seconds, 700.0);
  EXPECT_NEAR(static_cast<double>(after.right - before.right), -1.0 * kTicksPerRad * seconds, 400.0);
}

TEST(DualAxis, a_command_that_is_not_refreshed_becomes_zero) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.5);
  bench.run(0.15);
  EXPECT_EQ(bench.node.order().rate[0], 0.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::enabled);
}

TEST(DualAxis, refuses_commands_that_are_not_numbers_or_not_enabled) {
  Ready bench;
  EXPECT_EQ(bench.controller->command(1.0, 1.0, bench.now).error().code, ErrorCode::refused);
  ASSERT_TRUE(bench.enabled());
  EXPECT_TRUE(bench.controller->command(1.0, 1.0, bench.now).ok());
  EXPECT_FALSE(bench.controller->command(std::nan(""), 1.0, bench.now).ok());
  bench.run(0.1);
  EXPECT_FALSE(bench.node.order().torque && bench.node.order().rate[0] != 0.0);
}

TEST(DualAxis, quick_stop_takes_effect_at_once_and_stays) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.5);
  bench.controller->quick_stop(bench.now);
  bench.run(0.02);
  EXPECT_EQ(bench.node.order().rate[0], 0.0);
  for (int i = 0; i < 20; ++i) {
    bench.controller->quick_stop(bench.now);
    bench.run(0.02);
  }
  bench.run(1.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::disabled);
  EXPECT_FALSE(bench.controller->command(1.0, 1.0, bench.now).ok());
  EXPECT_TRUE(bench.enabled());  // a person may start again
}

// The last status that came is older than the stop: it shows axes that follow.
TEST(DualAxis, enabled_right_after_a_stop_it_ends_the_motion_first) {
  for (const double pause : {0.0, 0.001, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2}) {
    Enabled bench;
    bench.drive(2.0, 2.0, 0.5);
    bench.controller->quick_stop(bench.now);
    bench.controller->disable(bench.now);
    bench.run(pause);
    bench.controller->enable(bench.now);
    EXPECT_EQ(bench.controller->state(), ControllerState::enabling) << pause;
    EXPECT_TRUE(bench.run_until([&] { return !bench.node.order().torque; }, 1.0)) << pause;
    ASSERT_TRUE(bench.enabled_within(2.0)) << pause;
    bench.drive(2.0, 2.0, 0.5);
    EXPECT_EQ(bench.find("axis_not_enabled"), nullptr) << pause;
    EXPECT_EQ(bench.controller->state(), ControllerState::enabled) << pause;
  }
}

TEST(DualAxis, stopped_again_before_the_motion_has_ended_it_is_not_enabled) {
  using Call = void (Controller::*)(double);
  for (const Call call : {&Controller::quick_stop, &Controller::disable}) {
    Enabled bench;
    bench.drive(2.0, 2.0, 0.5);
    bench.controller->quick_stop(bench.now);
    bench.controller->enable(bench.now);
    bench.run(0.01);
    (bench.controller.get()->*call)(bench.now);
    bench.run(2.0);
    EXPECT_EQ(bench.controller->state(), ControllerState::disabled);
  }
}

TEST(DualAxis, a_quick_stop_that_is_lost_on_the_bus_is_sent_again) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.5);
  bench.controller->quick_stop(bench.now);
  EXPECT_FALSE(bench.controller->take_frames().empty());
  EXPECT_NE(bench.node.order().rate[0], 0.0);
  bench.run(0.05);
  EXPECT_EQ(bench.node.order().rate[0], 0.0);
}

TEST(DualAxis, that_does_not_get_its_torque_says_so) {
  Bench bench;
  ASSERT_TRUE(bench.ready());
  bench.controller->enable(bench.now);
  bench.lost_id = 0x201;  // the control word
  bench.run(3.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::disabled);
  const ControllerEvent* const said = bench.find("enable_failed");
  ASSERT_NE(said, nullptr);
  EXPECT_NE(said->text.find("the axes do not get beyond"), std::string::npos) << said->text;
  EXPECT_FALSE(said->stop);
}

TEST(DualAxis, disable_ends_without_torque) {
  Enabled bench;
  bench.drive(1.0, 1.0, 0.3);
  bench.controller->disable(bench.now);
  EXPECT_TRUE(bench.run_until([&] { return bench.controller->state() == ControllerState::disabled; }, 2.0));
  EXPECT_FALSE(bench.node.order().torque);
}

TEST(DualAxis, is_not_enabled_without_a_watchdog) {
  Bench bench;
  bench.node.sdo_faults().abort_on_write[{0x1016, 1}] = static_cast<sim::AbortCode>(0x06020000);
  ASSERT_TRUE(bench.ready());
  EXPECT_FALSE(bench.controller->watchdog_armed());
  bench.controller->enable(bench.now);
  bench.run(1.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::disabled);
  EXPECT_NE(bench.find("enable_refused"), nullptr);
}

TEST(DualAxis, a_watchdog_that_reads_back_otherwise_is_not_armed) {
  Bench bench;
  bench.node.sdo_faults().read_back[{0x6007, 0}] = 0;
  ASSERT_TRUE(bench.ready());
  EXPECT_FALSE(bench.controller->watchdog_armed());
}

TEST(DualAxis, the_drive_stops_by_itself_when_this_program_is_silent) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.5);
  bench.link_to_node = false;
  bench.run(0.5);
  EXPECT_FALSE(bench.node.order().torque && bench.node.order().rate[0] != 0.0);
}

TEST(DualAxis, a_lost_heartbeat_is_a_stop_event_and_heals) {
  Ready bench;
  bench.node.faults.heartbeat_stopped = true;
  const double start = bench.now;
  ASSERT_TRUE(bench.run_until([&] { return bench.find("heartbeat_lost") != nullptr; }, 0.5));
  EXPECT_LT(bench.now - start, 0.1);
  EXPECT_TRUE(bench.find("heartbeat_lost")->stop);
  EXPECT_EQ(bench.controller->state(), ControllerState::absent);
  bench.node.faults.heartbeat_stopped = false;
  EXPECT_TRUE(bench.ready());
  EXPECT_GT(bench.ticks.back().segment, 0);
}

TEST(DualAxis, frozen_process_data_stops_within_a_quarter_second) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.3);
  bench.node.faults.pdo_silent = true;
  const double start = bench.now;
  bench.drive(2.0, 2.0, 0.2);
  ASSERT_NE(bench.find("pdo_frozen"), nullptr);
  EXPECT_LT(bench.find("pdo_frozen")->t - start, 0.13);
  EXPECT_FALSE(bench.node.order().torque && bench.node.order().rate[0] != 0.0);
}

TEST(DualAxis, counts_that_stand_still_under_command_stop) {
  Enabled bench;
  bench.wheels_turn = false;
  bench.drive(2.0, 2.0, 1.0);
  ASSERT_NE(bench.find("encoder_stuck"), nullptr);
  EXPECT_TRUE(bench.find("encoder_stuck")->stop);
}

TEST(DualAxis, counts_that_freeze_in_motion_stop_within_a_tenth_of_a_second) {
  Enabled bench;
  bench.drive(2.0, 2.0, 0.5);
  EXPECT_EQ(bench.find("encoder_stuck"), nullptr);
  const double start = bench.now;
  bench.wheels_turn = false;
  bench.drive(2.0, 2.0, 0.2);
  ASSERT_NE(bench.find("encoder_stuck"), nullptr);
  EXPECT_LT(bench.find("encoder_stuck")->t - start, 0.1);
  EXPECT_FALSE(bench.node.order().torque && bench.node.order().rate[0] != 0.0);
}

TEST(DualAxis, a_wheel_that_breaks_away_late_or_stalls_for_a_moment_is_no_stuck_encoder) {
  Enabled bench;
  bench.wheels_turn = false;
  bench.drive(2.0, 2.0, 0.25);
  bench.wheels_turn = true;
  bench.drive(2.0, 2.0, 0.5);
  bench.wheels_turn = false;
  bench.drive(2.0, 2.0, 0.06);
  bench.wheels_turn = true;
  bench.drive(2.0, 2.0, 0.5);
  EXPECT_EQ(bench.find("encoder_stuck"), nullptr);
}

TEST(DualAxis, standing_still_on_command_is_no_stuck_encoder) {
  Enabled bench;
  bench.drive(0.0, 0.0, 3.0);
  EXPECT_TRUE(bench.events.empty());
}

TEST(DualAxis, an_emergency_message_stops) {
  Enabled bench;
  bench.drive(1.0, 1.0, 0.3);
  bench.node.emergency(0x8611, 0x20, bench.now);
  bench.run(0.05);
  ASSERT_NE(bench.find("emcy"), nullptr);
  EXPECT_TRUE(bench.find("emcy")->stop);
  EXPECT_NE(bench.find("emcy")->text.find("following error"), std::string::npos);
  EXPECT_FALSE(bench.controller->command(1.0, 1.0, bench.now).ok());
}

struct Foreign {
  const char* name;
  std::uint32_t id;
  std::vector<std::uint8_t> data;
  bool stops;
};

// The node is 1.
const Foreign kForeign[] = {
    {"speeds", 0x301, {1, 0, 0, 0, 1, 0, 0, 0}, true},
    {"control words", 0x201, {0x0F, 0, 0x0F, 0}, true},
    {"NMT to the node", 0x000, {0x02, 1}, true},
    {"NMT to all", 0x000, {0x02, 0}, true},
    {"NMT to another node", 0x000, {0x02, 2}, false},
    {"SDO download", 0x601, {0x23, 0xFF, 0x60, 1, 0, 0, 0, 0}, true},
    {"SDO download segment", 0x601, {0x01, 0, 0, 0, 0, 0, 0, 0}, true},
    {"SDO block download", 0x601, {0xC2, 0xFF, 0x60, 1, 0, 0, 0, 0}, true},
    {"SDO upload", 0x601, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0}, false},
    {"SDO upload segment", 0x601, {0x60, 0, 0, 0, 0, 0, 0, 0}, false},
    {"SDO abort", 0x601, {0x80, 0x18, 0x10, 1, 0, 0, 0, 0}, false},
    {"speeds by process data that the profile does not list", 0x401, {1, 0, 0, 0, 1, 0, 0, 0}, true},
    {"speeds to another node", 0x302, {1, 0, 0, 0, 1, 0, 0, 0}, false},
};

TEST(DualAxis, another_program_that_commands_its_node_stops_the_wheels) {
  for (const Foreign& foreign : kForeign) {
    Enabled bench;
    bench.drive(1.0, 1.0, 0.3);
    const sim::Frame sent{foreign.id, false, false, static_cast<std::uint8_t>(foreign.data.size()), {}};
    CanFrame frame = to_can(sent, bench.now);
    std::copy(foreign.data.begin(), foreign.data.end(), frame.data.begin());
    for (int twice = 0; twice < 2; ++twice) bench.controller->on_frame(frame);
    bench.drive(1.0, 1.0, 0.05);
    const auto* told = bench.find("other_master");
    EXPECT_EQ(told != nullptr && told->stop, foreign.stops) << foreign.name;
    EXPECT_NE(bench.controller->command(1.0, 1.0, bench.now).ok(), foreign.stops) << foreign.name;
  }
}

// At rest it is told, once.
TEST(DualAxis, another_program_is_no_stop_where_nothing_moves) {
  Ready bench;
  CanFrame frame = to_can({0x301, false, false, 8, {}}, bench.now);
  for (int i = 0; i < 20; ++i) bench.controller->on_frame(frame);
  bench.run(0.1);
  const auto told = std::count_if(bench.events.begin(), bench.events.end(),
                                  [](const auto& event) { return event.code == "other_master"; });
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(bench.find("other_master")->stop);
  EXPECT_EQ(bench.controller->counters().at("other_master"), 20U);
}

TEST(DualAxis, enabling_resets_a_fault) {
  Ready bench;
  bench.node.emergency(0x2310, 0x02, bench.now);
  ASSERT_TRUE(bench.run_until([&] { return bench.controller->state() == ControllerState::fault; }, 0.5));
  bench.controller->enable(bench.now);
  EXPECT_TRUE(bench.enabled_within(2.0));
}

TEST(DualAxis, an_unexpected_boot_up_stops_and_configures_anew) {
  Enabled bench;
  bench.drive(1.0, 1.0, 0.3);
  bench.node.reset(bench.now);
  bench.run(0.3);
  EXPECT_NE(bench.find("unexpected_boot"), nullptr);
  ASSERT_TRUE(bench.ready());
  EXPECT_TRUE(bench.controller->watchdog_armed());
  EXPECT_FALSE(bench.node.order().torque);
}

TEST(DualAxis, finds_a_drive_that_is_switched_on_later) {
  Bench bench;
  bench.link_from_node = false;
  bench.run(3.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::absent);
  bench.link_from_node = true;
  EXPECT_TRUE(bench.run_until([&] { return bench.controller->state() == ControllerState::disabled; }, 2.5));
}

TEST(DualAxis, bus_off_is_a_stop_event) {
  Ready bench;
  CanFrame frame;
  frame.error = true;
  frame.id = 0x040;
  frame.length = 8;
  frame.t = bench.now;
  bench.controller->on_frame(frame);
  bench.run(0.01);
  ASSERT_NE(bench.find("bus_off"), nullptr);
  EXPECT_TRUE(bench.find("bus_off")->stop);
}

TEST(DualAxisParameters, are_written_read_back_and_stored) {
  Ready bench;
  bench.run(0.2);
  ASSERT_TRUE(
      bench.controller
          ->start_write_parameters({{"left_wheel_diameter", 0.1512344}, {"track_width", 0.41}}, bench.now)
          .ok());
  const auto written = bench.job();
  EXPECT_FALSE(written.error) << written.error->text();
  ASSERT_EQ(written.parameters.size(), 2U);
  EXPECT_EQ(written.parameters[0].raw, 151234);
  EXPECT_EQ(bench.node.geometry_in_ram()[0], 151234U);
  EXPECT_EQ(bench.node.geometry_stored()[0], 150000U);
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  EXPECT_FALSE(bench.job().error);
  EXPECT_EQ(bench.node.geometry_stored()[0], 151234U);
  EXPECT_EQ(bench.node.store_count(), 1U);
  EXPECT_TRUE(bench.events.empty());
}

TEST(DualAxisParameters, are_read_before_rest_is_known_but_not_changed) {
  Ready bench;
  EXPECT_FALSE(bench.controller->at_rest());
  EXPECT_EQ(bench.controller->start_store(bench.now).error().what, "wheels are turning");
  EXPECT_EQ(bench.controller->start_write_parameters({{"track_width", 0.41}}, bench.now).error().what,
            "wheels are turning");
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  EXPECT_EQ(bench.job().parameters.size(), 3U);
  EXPECT_TRUE(bench.run_until([&] { return bench.controller->at_rest(); }, 0.2));
  EXPECT_TRUE(bench.controller->start_write_parameters({{"track_width", 0.41}}, bench.now).ok());
}

TEST(DualAxisParameters, a_result_that_nobody_took_is_not_given_for_the_next_job) {
  Ready bench;
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  bench.run(0.5);
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  EXPECT_FALSE(bench.controller->take_job_result());
  EXPECT_EQ(bench.job().kind, ParameterJobResult::Kind::store);
}

TEST(DualAxisParameters, a_store_may_take_as_long_as_the_profile_allows) {
  Bench bench(changed_profile("wait_s = 5", "wait_s = 60", "slow-store.toml"));
  ASSERT_TRUE(bench.ready());
  bench.run(0.2);
  bench.node.sdo_faults().answer_delay[{0x1010, 1}] = 55.0;
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  bench.run(54.0);
  EXPECT_FALSE(bench.controller->take_job_result());
  const auto result = bench.job();
  EXPECT_FALSE(result.error) << result.error->text();
}

TEST(DualAxisParameters, every_job_ends_by_itself_when_the_drive_falls_silent) {
  using Start = std::function<Result<void>(Controller&, double)>;
  const std::vector<Start> jobs = {[](Controller& c, double now) { return c.start_read_parameters(now); },
                                   [](Controller& c, double now) {
                                     return c.start_write_parameters({{"track_width", 0.41}}, now);
                                   },
                                   [](Controller& c, double now) { return c.start_store(now); }};
  for (const Start& start : jobs)
    for (const double after : {0.0, 0.002, 0.005, 0.02}) {
      Ready bench;
      bench.run(0.2);
      ASSERT_TRUE(start(*bench.controller, bench.now).ok());
      bench.run(after);
      bench.link_from_node = bench.link_to_node = false;
      (void)bench.job();  // fails by itself when none comes within 10 s
    }
}

TEST(DualAxisParameters, are_refused_while_enabled) {
  Enabled bench;
  bench.drive(0.0, 0.0, 0.5);
  ASSERT_TRUE(bench.controller->at_rest());
  for (const auto& refused : {bench.controller->start_read_parameters(bench.now),
                              bench.controller->start_write_parameters({{"track_width", 0.41}}, bench.now),
                              bench.controller->start_store(bench.now)}) {
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().what, "axes are not disabled");
  }
}

TEST(DualAxisParameters, refuse_unknown_quantities_and_values_out_of_range) {
  Ready bench;
  bench.run(0.2);
  for (const ParameterValue& value : {ParameterValue{"wheel_colour", 0.1},
                                      {"track_width", -0.4},
                                      {"track_width", std::nan("")},
                                      {"track_width", 1e9}})
    EXPECT_FALSE(bench.controller->start_write_parameters({value}, bench.now).ok())
        << value.quantity << value.value;
  EXPECT_FALSE(bench.controller->start_write_parameters({}, bench.now).ok());
}

TEST(DualAxisParameters, old_values_come_back_when_the_second_write_is_refused) {
  Ready bench;
  bench.run(0.2);
  bench.node.sdo_faults().abort_on_write[{0x2100, 3}] = static_cast<sim::AbortCode>(0x06090030);
  ASSERT_TRUE(bench.controller
                  ->start_write_parameters({{"left_wheel_diameter", 0.16}, {"track_width", 0.41}}, bench.now)
                  .ok());
  const auto result = bench.job();
  ASSERT_TRUE(result.error);
  EXPECT_EQ(bench.node.geometry_in_ram()[0], 150000U);
  EXPECT_EQ(bench.node.geometry_in_ram()[2], 400000U);
}

TEST(DualAxisParameters, a_failing_store_is_told_and_the_stored_set_is_the_old_one) {
  Ready bench;
  bench.run(0.2);
  bench.node.faults.store_fails = true;
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  const auto result = bench.job();
  ASSERT_TRUE(result.error);
  EXPECT_EQ(result.error->code, ErrorCode::write_failed);
}

TEST(DualAxisParameters, a_store_without_answer_is_unknown_and_not_repeated) {
  Ready bench;
  bench.run(0.2);
  bench.node.sdo_faults().answer_delay[{0x1010, 1}] = 100.0;
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  const auto result = bench.job();
  ASSERT_TRUE(result.error);
  EXPECT_EQ(result.error->code, ErrorCode::write_unknown);
  EXPECT_EQ(bench.node.store_count(), 1U);
}

}  // namespace
}  // namespace odomcalib::drivers::dual_axis_test
