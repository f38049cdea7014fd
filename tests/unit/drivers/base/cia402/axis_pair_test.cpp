// The generic pair of single-axis CiA 402 drives against two simulated ones on one bus.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "tests/sim/wires/drive_node.hpp"
#include "tests/unit/drivers/base/bench.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::axis_pair_test {
namespace {

constexpr double kCounts = 65536.0;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Two drives, nodes 2 and 3; each turns its wheel as ordered, at once.
struct TwoDrives {
  TwoDrives() {
    for (std::size_t side = 0; side < 2; ++side) {
      sim::DriveNodeOptions options;
      options.node_id = static_cast<std::uint8_t>(2 + side);
      options.serial = static_cast<std::uint32_t>(100 + side);
      options.single_axis = true;
      node[side] = std::make_unique<sim::DriveNode>(options);
    }
  }
  std::vector<sim::Frame> exchange(const std::vector<sim::Frame>& sent, double now) {
    std::vector<sim::Frame> out;
    for (const sim::Frame& frame : sent) life_signs += frame.id == 0x77F ? 1 : 0;
    for (std::size_t side = 0; side < 2; ++side) {
      for (const sim::Frame& frame : sent) node[side]->receive(frame, now);
      const sim::MotorOrder order = node[side]->order();
      rate[side] = order.torque ? order.rate[0] : 0.0;
      angle[side] += rate[side] * (last > 0.0 ? now - last : 0.0);
      sim::WheelState wheels;
      wheels.counts[0] = static_cast<std::int64_t>(std::floor(angle[side] / kTwoPi * kCounts));
      wheels.rate[0] = rate[side];
      node[side]->advance(now, wheels);
      for (const sim::Frame& frame : node[side]->take_frames(now)) out.push_back(frame);
    }
    last = now;
    return out;
  }

  std::array<std::unique_ptr<sim::DriveNode>, 2> node;
  std::array<double, 2> rate{}, angle{};
  double last = 0.0;
  int life_signs = 0;  ///< of this program
};

/// The shipped profile, with the speed unit of the simulated drive.
std::unique_ptr<Controller> pair_controller() {
  std::string text = test::read_text("drivers/base/profiles/cia402-pair.toml");
  const std::string unit = "rpm_per_count = 1.0";
  text.replace(text.find(unit), unit.size(), "rpm_per_count = 0.01");
  const auto path = std::filesystem::temp_directory_path() /
                    ("odomcalib-axis-pair-test-" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << text;
  auto made = make_controller(path.string());
  std::filesystem::remove(path);
  if (!made) ADD_FAILURE() << made.error().text();
  return std::move(made).value();
}

class AxisPair : public testing::Test {
 protected:
  AxisPair()
      : bench_(pair_controller(), [this](const auto& sent, double t) { return drives_.exchange(sent, t); }) {}

  void ready() {
    ASSERT_TRUE(bench_.run_until(ControllerState::disabled)) << bench_.story();
    bench_.run(0.3);  // until the wheels are known to stand
  }
  void moving() {
    ready();
    bench_.controller->enable(bench_.now);
    ASSERT_TRUE(bench_.run_until(ControllerState::enabled)) << bench_.story();
    bench_.drive(4.0, 4.0, 0.5);
  }
  ParameterJobResult job() {
    for (int i = 0; i < 20'000; ++i) {
      bench_.turn();
      if (auto result = bench_.controller->take_job_result()) return *result;
    }
    ADD_FAILURE() << "the job does not end";
    return {};
  }
  [[nodiscard]] std::uint32_t feed(std::size_t side) {
    return drives_.node[side]->dictionary().value({0x6092, 1});
  }

  TwoDrives drives_;
  test::CanBench bench_;
};

TEST_F(AxisPair, moves_both_wheels_and_dates_their_counts_by_the_sync) {
  moving();
  EXPECT_TRUE(bench_.controller->watchdog_armed());
  bench_.ticks.clear();
  bench_.drive(4.0, 5.0, 2.0);
  EXPECT_GT(drives_.rate[0], 0.0);
  EXPECT_LT(drives_.rate[1], 0.0);  // mounted mirrored
  ASSERT_NEAR(static_cast<double>(bench_.ticks.size()), 100.0, 5.0);
  // Counts against time are straight lines: both counts were taken at the date of the sample.
  const TickSample& first = bench_.ticks[10];
  for (std::size_t i = 20; i < bench_.ticks.size(); ++i) {
    const double dt = bench_.ticks[i].t - first.t;
    EXPECT_NEAR(static_cast<double>(bench_.ticks[i].left - first.left), 4.0 * dt / kTwoPi * kCounts,
                2.0e-4 * kCounts * 4.0);
    EXPECT_NEAR(static_cast<double>(bench_.ticks[i].right - first.right), 5.0 * dt / kTwoPi * kCounts,
                2.0e-4 * kCounts * 5.0);
  }
  EXPECT_EQ(bench_.controller->counters()["unpaired_counts"], 0U);
}

TEST_F(AxisPair, a_fault_of_one_drive_stops_both) {
  moving();
  drives_.node[1]->emergency(0x2310, 0x02, bench_.now);
  bench_.drive(4.0, 4.0, 0.2);
  EXPECT_TRUE(bench_.happened("emcy")) << bench_.story();
  EXPECT_EQ(drives_.rate[0], 0.0);
  EXPECT_EQ(drives_.rate[1], 0.0);
  EXPECT_NE(bench_.story().find("right drive: emergency"), std::string::npos);
}

TEST_F(AxisPair, either_drive_that_somebody_changed_is_found_and_set_up_again) {
  ready();
  for (const std::size_t side : {0U, 1U}) {
    sim::ObjectDictionary& held = drives_.node[side]->dictionary();
    const std::uint32_t watchdog = held.value({0x1016, 1});
    held.set({0x1016, 1}, 0);
    ASSERT_TRUE(bench_.controller->start_read_parameters(bench_.now).ok());
    const auto result = job();
    ASSERT_TRUE(result.error) << side;
    EXPECT_NE(result.error->text().find("1016:01 reads 0"), std::string::npos) << result.error->text();
    EXPECT_NE(bench_.story().find(side == 0 ? "left drive: object 1016" : "right drive: object 1016"),
              std::string::npos)
        << bench_.story();
    EXPECT_FALSE(bench_.controller->watchdog_armed());
    ready();
    EXPECT_EQ(held.value({0x1016, 1}), watchdog);
    ASSERT_TRUE(bench_.controller->start_read_parameters(bench_.now).ok());
    EXPECT_FALSE(job().error);
  }
}

// Before a person starts it again it is read, as any other.
TEST_F(AxisPair, a_drive_in_fault_is_read_but_not_written) {
  ready();
  drives_.node[1]->emergency(0x2310, 0x02, bench_.now);
  ASSERT_TRUE(bench_.run_until(ControllerState::fault)) << bench_.story();
  EXPECT_FALSE(bench_.controller->start_write_parameters({{"left_wheel_diameter", 0.151}}, bench_.now).ok());
  ASSERT_TRUE(bench_.controller->start_read_parameters(bench_.now).ok());
  EXPECT_FALSE(job().error);
}

TEST_F(AxisPair, a_quick_stop_is_on_its_way_before_anything_else_happens) {
  moving();
  ASSERT_NE(drives_.rate[0], 0.0);
  bench_.controller->quick_stop(bench_.now);
  bench_.flush();
  EXPECT_EQ(drives_.rate[0], 0.0);
  EXPECT_EQ(drives_.rate[1], 0.0);
}

TEST(DualAxisOnItsWire, a_quick_stop_is_on_its_way_before_anything_else_happens) {
  sim::DriveNode node({});
  node.reset(0.0);
  test::CanBench bench(test::shipped("sim-dual"), [&node](const std::vector<sim::Frame>& sent, double now) {
    for (const sim::Frame& frame : sent) node.receive(frame, now);
    node.advance(now, {});
    return node.take_frames(now);
  });
  ASSERT_TRUE(bench.run_until(ControllerState::disabled)) << bench.story();
  bench.run(0.5);
  bench.controller->enable(bench.now);
  ASSERT_TRUE(bench.run_until(ControllerState::enabled)) << bench.story();
  bench.drive(2.0, 2.0, 0.06);
  ASSERT_NE(node.order().rate[0], 0.0);
  bench.controller->quick_stop(bench.now);
  bench.flush();
  EXPECT_EQ(node.order().rate[0], 0.0);
}

TEST_F(AxisPair, a_missing_drive_keeps_the_other_from_moving) {
  ready();
  drives_.node[0]->faults.heartbeat_stopped = true;
  drives_.node[0]->sdo_faults().silent = true;
  bench_.run(1.0);
  EXPECT_TRUE(bench_.happened("heartbeat_lost")) << bench_.story();
  EXPECT_NE(bench_.controller->state(), ControllerState::disabled);
  bench_.controller->enable(bench_.now);
  bench_.run(0.5);
  EXPECT_EQ(drives_.node[1]->drive_state(), sim::DriveState::switch_on_disabled);
}

TEST_F(AxisPair, feeds_are_read_written_stored_and_seen_after_a_reset) {
  ready();
  ASSERT_TRUE(bench_.controller->start_read_parameters(bench_.now).ok());
  const auto read = job();
  ASSERT_EQ(read.parameters.size(), 2U);
  EXPECT_NEAR(read.parameters[0].value, 0.150, 1e-8);
  EXPECT_LT(read.parameters[0].step / 0.150, 1e-7);
  ASSERT_TRUE(bench_.controller
                  ->start_write_parameters(
                      {{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1497}}, bench_.now)
                  .ok());
  EXPECT_FALSE(job().error);
  EXPECT_EQ(feed(0), static_cast<std::uint32_t>(std::llround(std::numbers::pi * 100 * 151200)));
  EXPECT_EQ(feed(1), static_cast<std::uint32_t>(std::llround(std::numbers::pi * 100 * 149700)));
  ASSERT_TRUE(bench_.controller->start_store(bench_.now).ok());
  const auto stored = job();
  EXPECT_FALSE(stored.error) << stored.error->text();
  EXPECT_TRUE(bench_.happened("restarted_to_verify"));
  EXPECT_FALSE(bench_.happened("unexpected_boot")) << bench_.story();
  EXPECT_EQ(drives_.node[0]->store_count(), 1U);
  EXPECT_EQ(drives_.node[1]->store_count(), 1U);
  ready();
  moving();
}

TEST_F(AxisPair, counts_of_a_turn_stay_what_they_are_with_another_feed) {
  ready();
  ASSERT_TRUE(bench_.controller->start_write_parameters({{"left_wheel_diameter", 0.2}}, bench_.now).ok());
  EXPECT_FALSE(job().error);
  moving();
  bench_.ticks.clear();
  bench_.drive(4.0, 4.0, 2.0);
  const TickSample &first = bench_.ticks[10], &last = bench_.ticks.back();
  const double turns = 4.0 * (last.t - first.t) / kTwoPi;
  EXPECT_NEAR(static_cast<double>(last.left - first.left) / turns, kCounts, 0.01 * kCounts)
      << "the host uses the new diameter already";
}

TEST_F(AxisPair, a_result_that_nobody_took_is_not_given_for_the_next_job) {
  ready();
  ASSERT_TRUE(bench_.controller->start_store(bench_.now).ok());
  bench_.run(10.0);
  ASSERT_TRUE(bench_.controller->start_read_parameters(bench_.now).ok());
  EXPECT_FALSE(bench_.controller->take_job_result());
  EXPECT_EQ(job().kind, ParameterJobResult::Kind::read);
}

TEST_F(AxisPair, a_store_that_is_lost_is_found_out_by_the_reset) {
  ready();
  ASSERT_TRUE(bench_.controller->start_write_parameters({{"left_wheel_diameter", 0.1512}}, bench_.now).ok());
  EXPECT_FALSE(job().error);
  drives_.node[0]->faults.store_is_lost = true;
  ASSERT_TRUE(bench_.controller->start_store(bench_.now).ok());
  const auto stored = job();
  ASSERT_TRUE(stored.error);
  EXPECT_EQ(stored.error->code, ErrorCode::write_failed);
  EXPECT_NE(stored.error->text().find("came back from a reset with other values"), std::string::npos);
}

TEST_F(AxisPair, a_drive_that_does_not_come_back_leaves_the_state_unknown) {
  ready();
  ASSERT_TRUE(bench_.controller->start_store(bench_.now).ok());
  for (int i = 0; i < 20'000 && !bench_.happened("restarted_to_verify"); ++i) bench_.turn();
  drives_.node[0]->sdo_faults().silent = true;
  const double reset = bench_.now;
  const auto stored = job();
  ASSERT_TRUE(stored.error);
  EXPECT_EQ(stored.error->code, ErrorCode::write_unknown);
  EXPECT_NEAR(bench_.now - reset, 10.0, 0.05) << "given up then";
}

// Both drives watch this program: one frame is the life sign for both.
TEST_F(AxisPair, gives_one_life_sign_for_both) {
  ready();
  drives_.life_signs = 0;
  bench_.run(1.0);
  EXPECT_NEAR(drives_.life_signs, 45, 6) << "every 20 ms";
}

TEST_F(AxisPair, when_the_second_drive_refuses_the_first_one_gets_its_old_value_back) {
  ready();
  const std::uint32_t before = feed(0);
  drives_.node[1]->sdo_faults().abort_on_write[{0x6092, 1}] = 0x06060000;
  ASSERT_TRUE(bench_.controller
                  ->start_write_parameters(
                      {{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1497}}, bench_.now)
                  .ok());
  const auto written = job();
  ASSERT_TRUE(written.error);
  // The second drive refuses its own old value too: what it holds is for a human to see.
  EXPECT_EQ(written.error->code, ErrorCode::write_unknown) << written.error->text();
  EXPECT_EQ(feed(0), before);
}

TEST_F(AxisPair, says_what_it_holds_and_who_they_are) {
  ready();
  for (const Capability& one : bench_.controller->capabilities()) {
    EXPECT_EQ(one.stored, one.quantity != "track_width") << one.quantity;
    EXPECT_EQ(one.writable, one.quantity != "track_width") << one.quantity;
  }
  EXPECT_NE(bench_.controller->identity()->name.find("(serial 100)"), std::string::npos);
  EXPECT_NE(bench_.controller->identity()->name.find("(serial 101)"), std::string::npos);
  ASSERT_EQ(bench_.controller->devices().size(), 2U);
  EXPECT_EQ(bench_.controller->devices()[0].serial, 100U);
  EXPECT_EQ(bench_.controller->devices()[1].serial, 101U);
  EXPECT_FALSE(bench_.controller->start_write_parameters({{"track_width", 0.4}}, bench_.now).ok());
}

}  // namespace
}  // namespace odomcalib::drivers::axis_pair_test
