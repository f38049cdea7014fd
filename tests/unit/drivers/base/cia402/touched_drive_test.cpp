// A drive that somebody else changed: what is known of it is read again, and it is set up again.
#include <gtest/gtest.h>

#include "tests/unit/drivers/base/cia402/drive_bench.hpp"

namespace odomcalib::drivers::touched_drive_test {
namespace {

using namespace drive_bench;

ParameterJobResult read(Bench& bench) {
  EXPECT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  return bench.job();
}

TEST(TouchedDrive, a_reading_of_a_drive_that_nobody_touched_finds_nothing) {
  Ready bench;
  const double begin = bench.now;
  const auto result = read(bench);
  EXPECT_FALSE(result.error) << result.error->text();
  EXPECT_EQ(result.parameters.size(), 3U);
  EXPECT_LT(bench.now - begin, 0.2) << "it is in the way of every motion";
}

struct Change {
  const char* name;
  sim::ObjectKey object;
  std::uint32_t value;
};

// Settings that keep the robot safe, and those that counts and commands go by.
const Change kChanges[] = {
    {"1016:01", {0x1016, 1}, 0},           {"1017:00", {0x1017, 0}, 31},
    {"6007:00", {0x6007, 0}, 0},           {"605A:00", {0x605A, 0}, 0},
    {"1A00:01", {0x1A00, 1}, 0x60640220},  {"1800:05", {0x1800, 5}, 200},
    {"1400:01", {0x1400, 1}, 0x80000201U}, {"1402:01", {0x1402, 1}, 0x401},
};

TEST(TouchedDrive, whatever_was_set_up_and_is_otherwise_is_named_and_set_up_again) {
  for (const Change& change : kChanges) {
    Ready bench;
    const std::uint32_t before = bench.node.dictionary().value(change.object);
    ASSERT_NE(before, change.value) << change.name;
    bench.node.dictionary().set(change.object, change.value);
    const auto result = read(bench);
    ASSERT_TRUE(result.error) << change.name;
    for (const std::string& named :
         {std::string(change.name), std::to_string(change.value), std::to_string(before)})
      EXPECT_NE(result.error->text().find(named), std::string::npos) << named << ": " << result.error->text();
    EXPECT_NE(bench.find("drive_changed"), nullptr) << change.name;
    EXPECT_FALSE(bench.controller->watchdog_armed()) << change.name;
    ASSERT_TRUE(bench.ready()) << change.name;
    EXPECT_TRUE(bench.controller->watchdog_armed()) << change.name;
    if (change.object.index != 0x605A) {  // which is only read
      EXPECT_EQ(bench.node.dictionary().value(change.object), before) << change.name;
    }
  }
}

TEST(TouchedDrive, a_reading_without_an_answer_is_no_change) {
  Ready bench;
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  bench.link_from_node = false;
  const auto result = bench.job();
  ASSERT_TRUE(result.error);
  EXPECT_EQ(bench.find("drive_changed"), nullptr);
}

TEST(TouchedDrive, process_data_that_the_profile_does_not_list_are_switched_off) {
  Bench bench;
  bench.node.dictionary().set({0x1602, 1}, 0x60FF0120);
  bench.node.dictionary().set({0x1602, 0}, 1);
  bench.node.dictionary().set({0x1402, 1}, 0x451);
  ASSERT_TRUE(bench.ready());
  EXPECT_EQ(bench.node.dictionary().value({0x1402, 1}), 0x80000451U);
  ASSERT_TRUE(bench.enabled());
  bench.foreign(0x451, {0x10, 0x27, 0, 0});
  EXPECT_EQ(bench.node.order().rate[0], 0.0);
  bench.run(0.05);
  ASSERT_NE(bench.find("other_master"), nullptr) << "rule M19";
  EXPECT_TRUE(bench.find("other_master")->stop);
}

TEST(TouchedDrive, a_drive_that_does_not_let_them_be_switched_off_is_told) {
  Bench bench;
  bench.node.dictionary().set({0x1402, 1}, 0x451);
  bench.node.sdo_faults().abort_on_write[{0x1402, 1}] = sim::abort_code::kReadOnly;
  ASSERT_TRUE(bench.ready());
  ASSERT_NE(bench.find("process_data_not_disabled"), nullptr);
  EXPECT_NE(bench.find("process_data_not_disabled")->text.find("1402:01"), std::string::npos);
  const auto result = read(bench);
  EXPECT_FALSE(result.error) << result.error->text();
}

TEST(TouchedDrive, it_is_known_until_it_was_read_again) {
  Ready bench;
  bench.foreign(0x601, {0x40, 0x16, 0x10, 1, 0, 0, 0, 0});
  bench.foreign(0x201, {0, 0});
  EXPECT_FALSE(bench.controller->touched()) << "who reads, or sends process data, changes no object";
  bench.foreign(0x601, {0x23, 0x00, 0x21, 1, 0xE0, 0x93, 0x04, 0});
  ASSERT_TRUE(bench.controller->touched());
  EXPECT_DOUBLE_EQ(*bench.controller->touched(), bench.now);
  bench.run(0.1);
  const auto result = read(bench);
  ASSERT_FALSE(result.error);
  EXPECT_NEAR(result.parameters.at(0).value, 0.3, 1e-9);
  EXPECT_FALSE(bench.controller->touched());
}

TEST(TouchedDrive, a_change_while_it_is_read_leaves_it_touched) {
  Ready bench;
  ASSERT_TRUE(bench.controller->start_read_parameters(bench.now).ok());
  bench.run(0.005);
  bench.foreign(0x601, {0x23, 0x00, 0x21, 1, 0xE0, 0x93, 0x04, 0});
  (void)bench.job();
  EXPECT_TRUE(bench.controller->touched());
}

// A control word that comes late gives torque when nobody wants it: it is taken away, unless another master
// wanted it.
TEST(TouchedDrive, late_torque_is_taken_away_though_somebody_reads_the_drive) {
  for (const bool writes : {false, true}) {
    Ready bench;
    bench.foreign(0x601, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0});
    if (writes) bench.foreign(0x601, {0x2B, 0x40, 0x60, 0, 0, 0, 0, 0});
    for (const int word : {0x06, 0x07, 0x0F}) {
      const sim::Frame late = sim::make_frame(0x201, {word, 0});
      bench.node.receive(late, bench.now);
      bench.run(0.002);
    }
    EXPECT_TRUE(bench.node.order().torque);
    bench.run(0.3);
    EXPECT_EQ(bench.node.order().torque, writes);
  }
}

TEST(TouchedDrive, is_set_up_and_written_though_every_frame_comes_twice) {
  Bench bench;
  bench.from_node = bench.to_node = sim::FrameLine({.doubled = 1.0}, 1);
  ASSERT_TRUE(bench.ready());
  bench.run(0.2);
  EXPECT_EQ(bench.controller->counters().at("sdo_bad"), 0U);
  ASSERT_TRUE(bench.controller
                  ->start_write_parameters({{"left_wheel_diameter", 0.16}, {"track_width", 0.41}}, bench.now)
                  .ok());
  const auto written = bench.job();
  EXPECT_FALSE(written.error) << written.error->text();
  ASSERT_TRUE(bench.controller->start_store(bench.now).ok());
  const auto stored = bench.job();
  EXPECT_FALSE(stored.error) << stored.error->text();
  EXPECT_EQ(bench.node.geometry_stored()[2], 410000U);
  ASSERT_TRUE(bench.enabled());
  bench.drive(1.0, 1.0, 1.0);
  EXPECT_EQ(bench.controller->state(), ControllerState::enabled);
  EXPECT_TRUE(bench.events.empty()) << bench.events[0].text;
}

}  // namespace
}  // namespace odomcalib::drivers::touched_drive_test
