// Outcome of a write-back that was interrupted, and of the next one after it.
#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::recovery_test {
namespace {

// Left old, right new, as after a crash between two writes. Both memories, so that a restart shows it too.
void mix(Memory& memory) {
  memory.ram["right_wheel_diameter"] = 149800;
  memory.stored = memory.ram;
}

// A journal that ends with an unfinished write-back, and a controller that holds a mixture.
class Interrupted : public testing::Test, public WriteBackBench<> {
 protected:
  Interrupted() { mix(memory); }
  void journaled(const JournalRecord& record) { ASSERT_TRUE(journal.append(record).ok()); }
  [[nodiscard]] bool untouched() const {
    return memory.ram.at("right_wheel_diameter") == 149800 &&
           memory.ram.at("left_wheel_diameter") == 150000 && controller.stores == 0;
  }
  void let_fail(int job) {
    controller.fail_at = controller.jobs + job;
    controller.mishap = Mishap::abort;
  }
};

TEST_F(Interrupted, a_read_that_fails_touches_neither_journal_nor_controller_and_the_next_one_restores) {
  journaled(record_of(JournalState::write));
  let_fail(0);
  const auto failed = recover();
  EXPECT_EQ(failed.outcome, WriteOutcome::read);
  EXPECT_TRUE(failed.error && failed.steps.empty() && untouched());
  EXPECT_EQ(journal.last()->state, JournalState::write);
  EXPECT_EQ(journal.unfinished()->before, kOld);
  EXPECT_EQ(recover().outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(is_old(memory.ram));
  EXPECT_FALSE(journal.unfinished());
}

TEST_F(Interrupted, an_apply_whose_read_fails_leaves_the_journal_as_it_was) {
  journaled(record_of(JournalState::write));
  let_fail(0);
  EXPECT_EQ(write(kNew).outcome, WriteOutcome::unknown);
  EXPECT_EQ(journal.last()->state, JournalState::write);
  EXPECT_TRUE(untouched());
}

TEST_F(Interrupted, an_empty_set_is_held_by_nobody) {
  EXPECT_FALSE(holds({}, {}));
  JournalRecord record = record_of(JournalState::needs_operator);
  record.before.clear();
  record.after.clear();
  journaled(record);
  const auto report = recover();
  EXPECT_EQ(report.outcome, WriteOutcome::unknown);
  EXPECT_TRUE(report.steps.empty() && untouched());
  ASSERT_TRUE(report.error);
  EXPECT_NE(report.error->what.find("does not say which values"), std::string::npos);
}

TEST_F(Interrupted, nothing_is_undone_while_the_wheels_turn) {
  journaled(record_of(JournalState::write));
  controller.rests = false;
  ASSERT_TRUE(transaction.recover().ok());
  EXPECT_FALSE(run(transaction, controller, 100));
  EXPECT_EQ(controller.jobs, 1);  // the read
  controller.rests = true;
  EXPECT_EQ(finish().outcome, WriteOutcome::rolled_back);
}

TEST_F(Interrupted, a_second_apply_that_fails_goes_back_to_the_values_of_the_journal_not_to_the_mixture) {
  journaled(record_of(JournalState::needs_operator));
  let_fail(1);
  const auto report = write(kNew);
  EXPECT_EQ(report.outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(report.before, kOld);
  EXPECT_TRUE(all_old());
  EXPECT_FALSE(journal.unfinished());
}

TEST_F(Interrupted, a_second_apply_that_dies_is_recovered_to_the_same_old_values_in_permanent_memory_too) {
  journaled(record_of(JournalState::needs_operator));
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  EXPECT_FALSE(run(transaction, controller, 1));  // journaled, not yet written
  Transaction next(journal);
  ASSERT_TRUE(next.recover().ok());
  EXPECT_EQ(run(next, controller).value().outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(all_old());
}

TEST_F(Interrupted, a_deliberate_apply_of_a_whole_set_is_a_way_out) {
  journaled(record_of(JournalState::needs_operator));
  EXPECT_EQ(write(kNew).outcome, WriteOutcome::committed);
  EXPECT_TRUE(all_new());
  EXPECT_FALSE(journal.unfinished());
}

TEST_F(Interrupted, a_part_of_the_values_does_not_close_the_journal) {
  journaled(record_of(JournalState::needs_operator));
  const auto report = write({{"track_width", 0.4021}});
  EXPECT_EQ(report.outcome, WriteOutcome::unknown);
  ASSERT_TRUE(report.error);
  EXPECT_NE(report.error->what.find("mixture"), std::string::npos);
  EXPECT_TRUE(journal.unfinished() && untouched());
}

TEST_F(Interrupted, an_apply_that_fails_where_no_old_values_are_known_still_needs_an_operator) {
  JournalRecord record = record_of(JournalState::needs_operator);
  record.before.clear();
  record.after.clear();
  journaled(record);
  let_fail(1);
  EXPECT_EQ(write(kNew).outcome, WriteOutcome::unknown);
  EXPECT_TRUE(journal.unfinished());
  EXPECT_EQ(write({{"track_width", 0.4021}}).outcome, WriteOutcome::unknown);
  EXPECT_EQ(write(kNew).outcome, WriteOutcome::committed);
}

TEST_F(Interrupted, what_was_never_stored_is_restored_without_a_store) {
  journaled(record_of(JournalState::write));
  memory.stored = Memory{}.stored;
  EXPECT_EQ(recover().outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(is_old(memory.ram));
  EXPECT_EQ(controller.stores, 0);
}

drivers::Identity drive(std::uint32_t serial) { return {0x0FEE, 0x0D15, 1, serial, "drive"}; }

TEST_F(Interrupted, another_controller_is_not_written) {
  controller.who = drive(1);
  JournalRecord record = record_of(JournalState::write);
  record.device = device_of(controller);
  journaled(record);
  controller.who = drive(2);
  for (const auto& values : {kOld, kNew}) {
    for (const auto& [name, value] : values) memory.ram[name] = std::llround(value * 1e6);
    const auto before = memory.ram;
    const auto report = recover();
    EXPECT_EQ(report.outcome, WriteOutcome::unknown);
    ASSERT_TRUE(report.error);
    EXPECT_NE(report.error->what.find("0xfee/0xd15/1\", this controller is \"0xfee/0xd15/2"),
              std::string::npos)
        << report.error->what;
    EXPECT_TRUE(report.steps.empty());
    EXPECT_EQ(controller.stores, 0);
    EXPECT_EQ(memory.ram, before);
    EXPECT_EQ(journal.last()->state, JournalState::write);
  }
  controller.who = drive(1);
  EXPECT_NE(recover().outcome, WriteOutcome::unknown);
}

TEST_F(Interrupted, an_apply_to_another_controller_goes_back_to_what_that_one_held) {
  JournalRecord record = record_of(JournalState::needs_operator);
  record.device = "somebody else";
  journaled(record);
  controller.who = drive(2);
  memory.ram["track_width"] = memory.stored["track_width"] = 500000;
  let_fail(1);
  EXPECT_EQ(write(kNew).outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(memory.ram.at("track_width"), 500000);
}

TEST_F(Interrupted, the_calibration_of_the_journal_comes_with_the_commit_of_the_recovery) {
  JournalRecord record = record_of(JournalState::store_begin);
  record.calibration = "an id";
  journaled(record);
  for (const auto& [name, value] : kNew) memory.ram[name] = std::llround(value * 1e6);
  const auto report = recover();
  EXPECT_EQ(report.outcome, WriteOutcome::committed);
  EXPECT_EQ(report.calibration, "an id");
  EXPECT_EQ(journal.last()->calibration, "an id");
}

}  // namespace
}  // namespace odomcalib::recovery_test
