// New values that wait in the controller's RAM for a motion to prove them (step 5 of the write-back
// protocol).
#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::proof_test {
namespace {

const Error kWorse{ErrorCode::write_failed, "a metre is worse", "proof run", ""};

class WaitingForProof : public testing::Test, public WriteBackBench<> {
 protected:
  /// Up to the wait for the proof.
  WriteReport write_unproven() { return write(kNew, Proof::wanted); }
  WriteReport conclude(const Result<void>& proof) {
    EXPECT_TRUE(transaction.conclude(proof).ok());
    return finish();
  }
};

TEST_F(WaitingForProof, new_values_are_in_ram_alone) {
  const auto report = write_unproven();
  EXPECT_EQ(report.outcome, WriteOutcome::proving);
  EXPECT_TRUE(holds(report.in_force, kNew));
  EXPECT_TRUE(is_new(memory.ram) && is_old(memory.stored));
  EXPECT_TRUE(transaction.proving() && transaction.busy());
  EXPECT_FALSE(run(transaction, controller));  // however long it takes
  EXPECT_EQ(controller.stores, 0);
  ASSERT_TRUE(journal.unfinished());
  EXPECT_TRUE(journal.unfinished()->unproven);
}

TEST_F(WaitingForProof, proven_values_are_stored_once) {
  EXPECT_FALSE(write_unproven().origin.proven);
  const auto report = conclude({});
  EXPECT_EQ(report.outcome, WriteOutcome::committed);
  EXPECT_TRUE(report.origin.proven) << "the history says so";
  EXPECT_TRUE(journal.last()->origin.proven);
  EXPECT_TRUE(all_new());
  EXPECT_EQ(controller.stores, 1);
  const std::vector<std::string> steps{"begin",       "write",    "readback_ok", "proof_ok",
                                       "store_begin", "store_ok", "commit"};
  EXPECT_EQ(report.steps, steps);
}

TEST_F(WaitingForProof, what_is_not_proven_goes_back_without_a_store) {
  write_unproven();
  const auto report = conclude(kWorse);
  EXPECT_EQ(report.outcome, WriteOutcome::rolled_back);
  ASSERT_TRUE(report.error);
  EXPECT_EQ(report.error->what, kWorse.what);
  EXPECT_TRUE(all_old());
  EXPECT_EQ(controller.stores, 0);
  EXPECT_FALSE(journal.unfinished());
}

// Whatever becomes of the values: the figures are why.
TEST_F(WaitingForProof, what_was_driven_for_it_is_kept_with_its_end) {
  const DriveTrial trial{DriveErrors{0.02, 0.01, 0.1}, DriveErrors{0.001, 0.0, 0.01}};
  for (const Result<void>& proof : {Result<void>(kWorse), Result<void>()}) {
    write_unproven();
    ASSERT_TRUE(transaction.conclude(proof, trial).ok());
    EXPECT_EQ(finish().origin.trial, trial);
    EXPECT_EQ(journal.last()->origin.trial, trial);
  }
}

TEST_F(WaitingForProof, a_controller_that_stores_nothing_is_committed_or_restored_as_well) {
  controller.ram_only = true;
  write_unproven();
  EXPECT_EQ(conclude({}).outcome, WriteOutcome::committed);
  EXPECT_EQ(controller.stores, 0);
  memory = Memory{};
  write_unproven();
  EXPECT_EQ(conclude(kWorse).outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(is_old(memory.ram));
}

TEST_F(WaitingForProof, nothing_else_begins_meanwhile_and_nothing_is_concluded_twice) {
  EXPECT_FALSE(transaction.conclude({}).ok());
  write_unproven();
  EXPECT_FALSE(transaction.write("apply", kOld).ok());
  EXPECT_FALSE(transaction.read().ok());
  EXPECT_TRUE(transaction.conclude({}).ok());
  EXPECT_FALSE(transaction.conclude(kWorse).ok());
}

// Killed at each step, also with all of the new values in RAM: what nobody has proven is not stored.
class EveryCrashOfAProof : public testing::TestWithParam<std::tuple<int, bool, bool, Mishap>> {};

TEST_P(EveryCrashOfAProof, leaves_old_values_before_the_verdict_and_either_set_after_it) {
  const auto [steps, power_cycle, torn, mishap] = GetParam();
  const TemporaryFolder folder;
  Memory memory;
  const auto path = folder / "journal";
  bool concluded = false;
  {
    FakeController controller(memory);
    controller.fail_at = 1;
    controller.mishap = mishap;
    auto journal = Journal::open(path);
    Transaction transaction(journal.value());
    ASSERT_TRUE(transaction.write("apply", kNew, "", Proof::wanted).ok());
    for (int i = 0; i < steps; ++i) {
      transaction.step(controller, 0.01 * i, 1);
      if (transaction.proving() && i > 6) concluded = transaction.conclude({}).ok();
    }
  }
  lose(memory, path, power_cycle, torn);
  for (int round = 0; round < 2; ++round) {
    const AfterCrash after(memory, path);
    EXPECT_TRUE(is_old(memory.ram) || (concluded && is_new(memory.ram)));
    EXPECT_TRUE(round == 0 || after.outcome == WriteOutcome::read);
  }
}

INSTANTIATE_TEST_SUITE_P(Moments, EveryCrashOfAProof,
                         testing::Combine(testing::Range(0, 14), testing::Bool(), testing::Bool(),
                                          testing::Values(Mishap::none, Mishap::half_written)));

class EveryMishapOfAProof : public testing::TestWithParam<std::tuple<int, Mishap, bool>>,
                            public WriteBackBench<> {};

TEST_P(EveryMishapOfAProof, leaves_wholly_old_or_wholly_new_values_and_says_which) {
  bool proven = false;
  std::tie(controller.fail_at, controller.mishap, proven) = GetParam();
  auto report = write(kNew, Proof::wanted);
  if (report.outcome == WriteOutcome::proving) {
    ASSERT_TRUE(transaction.conclude(proven ? Result<void>{} : Result<void>(kWorse)).ok());
    report = finish();
  }
  const bool committed = report.outcome == WriteOutcome::committed;
  EXPECT_TRUE(proven || !committed);
  EXPECT_TRUE(committed ? all_new() : is_old(memory.stored));
  EXPECT_EQ(committed, !report.error);
  EXPECT_TRUE(report.outcome != WriteOutcome::rolled_back || is_old(memory.ram));
}

INSTANTIATE_TEST_SUITE_P(Jobs, EveryMishapOfAProof,
                         testing::Combine(testing::Range(0, 6),
                                          testing::Values(Mishap::none, Mishap::abort, Mishap::wrong_readback,
                                                          Mishap::half_written),
                                          testing::Bool()));

}  // namespace
}  // namespace odomcalib::proof_test
