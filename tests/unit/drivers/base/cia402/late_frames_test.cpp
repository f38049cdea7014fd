// Requests that the bus delivers once more, and answers that come late: what is written, read and stored is
// what was meant.
#include <gtest/gtest.h>

#include "drivers/base/canopen/settings.hpp"
#include "tests/unit/drivers/base/cia402/drive_bench.hpp"

namespace odomcalib::drivers::late_frames_test {
namespace {

using namespace drive_bench;

/// At rest, with everything sent so far forgotten.
struct AtRest : Ready {
  AtRest() {
    run(0.2);
    sent.clear();
  }
  void start_writing(const std::vector<ParameterValue>& values) {
    EXPECT_TRUE(controller->start_write_parameters(values, now).ok());
  }
  /// The first download to 2100:01 reaches the node once more now.
  void repeat_first_write() {
    for (const CanFrame& frame : sent)
      if (frame.id == 0x601 && frame.data[0] == 0x23 && frame.data[1] == 0x00 && frame.data[2] == 0x21 &&
          frame.data[3] == 1)
        return node.receive(to_sim(frame), now);
    ADD_FAILURE() << "no write was sent";
  }
  [[nodiscard]] std::uint32_t left() const { return node.geometry_in_ram()[0]; }
};

TEST(LateFrames, old_values_come_back_after_all_that_was_written) {
  AtRest bench;
  bench.node.sdo_faults().abort_on_write[{0x2100, 3}] = sim::abort_code::kRange;
  bench.start_writing({{"left_wheel_diameter", 0.16}, {"track_width", 0.41}});
  bench.run(0.3);
  bench.repeat_first_write();
  EXPECT_TRUE(bench.job().error);
  EXPECT_EQ(bench.left(), 150000U);
}

TEST(LateFrames, nothing_is_written_while_an_earlier_write_may_be_on_its_way) {
  AtRest bench;
  bench.start_writing({{"left_wheel_diameter", 0.16}});
  EXPECT_FALSE(bench.job().error);
  bench.start_writing({{"left_wheel_diameter", 0.15}});
  bench.run(0.3);
  bench.repeat_first_write();
  EXPECT_FALSE(bench.job().error);
  EXPECT_EQ(bench.left(), 150000U);
}

TEST(LateFrames, a_value_that_is_not_the_one_last_known_is_believed_when_it_was_read_twice) {
  AtRest bench;
  // A check of values that are all known begins at once.
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  EXPECT_FALSE(bench.job().error);
  bench.start_writing({{"left_wheel_diameter", 0.16}});
  EXPECT_FALSE(bench.job().error);
  bench.sent.clear();
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  const auto asks = [&] {
    if (bench.sent.empty()) return false;
    const CanFrame& frame = bench.sent.back();
    return frame.id == 0x601U && frame.data[0] == 0x40 && frame.data[2] == 0x21 && frame.data[3] == 1;
  };
  ASSERT_TRUE(bench.run_until(asks, 2.0));
  sim::Frame old = sim::make_frame(0x581, {0x43, 0x00, 0x21, 1, 0xF0, 0x49, 0x02, 0});  // 150000
  bench.controller->on_frame(to_can(old, bench.now));
  const auto stored = bench.job();
  EXPECT_FALSE(stored.error) << stored.error->text();
  EXPECT_EQ(bench.node.geometry_stored()[0], 160000U);
}

TEST(LateFrames, a_check_that_meets_a_late_answer_is_made_again) {
  AtRest bench;
  bench.start_writing({{"left_wheel_diameter", 0.16}});
  const auto writing = [&] { return bench.left() == 160000U; };
  ASSERT_TRUE(bench.run_until(writing, 1.0));
  bench.run(kStep);  // it is read back
  bench.controller->on_frame(
      to_can(sim::make_frame(0x581, {0x43, 0x00, 0x21, 1, 0xF0, 0x49, 0x02, 0}), bench.now));
  const auto written = bench.job();
  EXPECT_FALSE(written.error) << written.error->text();
}

TEST(LateFrames, a_refusal_that_answers_something_else_is_asked_for_again) {
  AtRest bench;
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  bench.run(kStep);
  const CanFrame& asked = bench.sent.back();
  ASSERT_EQ(asked.id, 0x601U);
  bench.controller->on_frame(to_can(
      sim::make_frame(0x581, {0x80, asked.data[1], asked.data[2], asked.data[3], 0x22, 0, 0, 8}), bench.now));
  const auto read = bench.job();
  EXPECT_FALSE(read.error) << read.error->text();
}

/// A write has begun when this is constructed.
struct Writing : AtRest {
  Writing() {
    start_writing({{"left_wheel_diameter", 0.16}, {"track_width", 0.41}});
    EXPECT_TRUE(run_until([&] { return left() == 160000U; }, 1.0));
  }
  void life_sign(std::uint8_t state) { controller->on_frame(to_can(sim::make_frame(0x701, {state}), now)); }
};

TEST(LateFrames, a_write_goes_on_while_life_signs_are_late) {
  AtRest bench;
  bench.start_writing({{"left_wheel_diameter", 0.16}});
  EXPECT_FALSE(bench.job().error);
  bench.node.faults.heartbeat_stopped = true;
  bench.start_writing({{"left_wheel_diameter", 0.15}});  // waits for what may still be on its way
  bench.run(0.3);
  bench.node.faults.heartbeat_stopped = false;
  const auto written = bench.job();
  EXPECT_FALSE(written.error) << written.error->text();
  EXPECT_EQ(bench.left(), 150000U);
  EXPECT_EQ(bench.find("heartbeat_lost"), nullptr);
}

TEST(LateFrames, life_signs_that_stay_away_are_missed_when_the_write_has_ended) {
  Writing bench;
  bench.node.faults.heartbeat_stopped = true;
  EXPECT_FALSE(bench.job().error);
  EXPECT_EQ(bench.find("heartbeat_lost"), nullptr);
  bench.run(0.1);
  EXPECT_NE(bench.find("heartbeat_lost"), nullptr);
}

TEST(LateFrames, a_write_goes_on_when_a_life_sign_of_before_the_start_comes) {
  Writing bench;
  bench.life_sign(0x7F);
  const auto written = bench.job();
  EXPECT_FALSE(written.error) << written.error->text();
  bench.run(0.2);
  EXPECT_EQ(bench.find("left_operational"), nullptr);
}

TEST(LateFrames, a_node_that_has_just_been_started_is_not_lost_by_a_life_sign_of_before) {
  Ready bench;
  bench.controller->on_frame(to_can(sim::make_frame(0x701, {0x7F}), bench.now));
  bench.run(0.2);
  EXPECT_EQ(bench.find("left_operational"), nullptr);
  bench.run(canopen::kSdoSettles_s);
  bench.controller->on_frame(to_can(sim::make_frame(0x701, {0x7F}), bench.now));
  EXPECT_EQ(bench.controller->state(), ControllerState::absent) << "none can come any more";
}

TEST(LateFrames, a_node_that_leaves_operational_during_a_job_is_lost_within_150_ms) {
  AtRest bench;
  bench.start_writing({{"left_wheel_diameter", 0.16}});
  EXPECT_FALSE(bench.job().error);
  bench.start_writing({{"left_wheel_diameter", 0.15}});  // waits for what may still be on its way
  bench.node.receive(sim::make_frame(0x000, {0x80, 1}), bench.now);
  bench.run(0.15);
  EXPECT_NE(bench.find("left_operational"), nullptr);
  EXPECT_TRUE(bench.job().error);
}

}  // namespace
}  // namespace odomcalib::drivers::late_frames_test
