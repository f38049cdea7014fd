#include <set>

#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::writeback_test {
namespace {

TEST(WriteBack, values_that_live_in_ram_only_are_not_stored) {
  WriteBackBench<> bench;
  bench.controller.ram_only = true;
  EXPECT_EQ(bench.write().outcome, WriteOutcome::committed);
  EXPECT_EQ(bench.controller.stores, 0);
  EXPECT_TRUE(is_new(bench.memory.ram));
  EXPECT_FALSE(bench.journal.unfinished());
}

TEST(Transaction, commits_after_one_store) {
  WriteBackBench<> bench;
  EXPECT_EQ(bench.write().outcome, WriteOutcome::committed);
  EXPECT_TRUE(bench.all_new());
  EXPECT_EQ(bench.controller.stores, 1);
  EXPECT_EQ(bench.journal.last()->state, JournalState::commit);
}

TEST(Transaction, refuses_values_that_are_no_lengths) {
  WriteBackBench<> bench;
  EXPECT_FALSE(bench.transaction.write("apply", {{"track_width", std::nan("")}}).ok());
  EXPECT_FALSE(bench.transaction.write("apply", {{"track_width", -0.4}}).ok());
  EXPECT_TRUE(bench.transaction.write("apply", kNew).ok());
  EXPECT_FALSE(bench.transaction.write("apply", kNew).ok());
}

/// The answers to its first stores are lost.
class UnansweredStores : public FakeController {
 public:
  UnansweredStores(Memory& memory, int lost) : FakeController(memory), lost_(lost) {}
  std::optional<ParameterJobResult> take_job_result() override {
    auto result = FakeController::take_job_result();
    const bool lost = result && result->kind == ParameterJobResult::Kind::store && lost_-- > 0;
    if (lost) result->error = Error{ErrorCode::write_unknown, "no answer", "store", ""};
    return result;
  }

 private:
  int lost_;
};

TEST(Transaction, old_values_whose_store_was_not_answered_are_stored_once_more) {
  for (const int lost : {2, 3}) {
    const TemporaryFolder folder;
    Memory memory;
    UnansweredStores controller(memory, lost);
    Journal journal = value_of(Journal::open(folder / "journal"));
    Transaction transaction(journal);
    ASSERT_TRUE(transaction.write("apply", kNew).ok());
    const auto report = run(transaction, controller);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->outcome, lost == 2 ? WriteOutcome::rolled_back : WriteOutcome::unknown);
    EXPECT_TRUE(is_old(memory.ram) && is_old(memory.stored));
    EXPECT_EQ(controller.stores, 3);
  }
}

class EveryMishap : public testing::TestWithParam<std::tuple<int, Mishap>>, public WriteBackBench<> {};

TEST_P(EveryMishap, leaves_wholly_old_or_wholly_new_values_and_says_which) {
  std::tie(controller.fail_at, controller.mishap) = GetParam();
  const auto report = write();
  ASSERT_NE(report.outcome, WriteOutcome::unknown);
  memory.power_cycle();
  if (report.outcome == WriteOutcome::committed)
    EXPECT_TRUE(is_new(memory.ram));
  else
    EXPECT_TRUE(is_old(memory.ram) && report.error.has_value());
}

INSTANTIATE_TEST_SUITE_P(Jobs, EveryMishap,
                         testing::Combine(testing::Range(0, 5),
                                          testing::Values(Mishap::none, Mishap::abort, Mishap::wrong_readback,
                                                          Mishap::half_written)));

// Kill after each number of steps, with or without a power cycle of the controller and a torn last record;
// then recover.
class EveryCrash : public testing::TestWithParam<std::tuple<int, bool, bool, Mishap>> {};

TEST_P(EveryCrash, is_decided_by_comparison_and_twice_changes_nothing) {
  const auto [steps, power_cycle, torn, mishap] = GetParam();
  const TemporaryFolder folder;
  Memory memory;
  const auto path = folder / "journal";
  {
    FakeController controller(memory);
    controller.fail_at = 1;
    controller.mishap = mishap;
    auto journal = Journal::open(path);
    Transaction transaction(journal.value());
    ASSERT_TRUE(transaction.write("apply", kNew).ok());
    run(transaction, controller, steps);
  }
  lose(memory, path, power_cycle, torn);
  (void)AfterCrash(memory, path);
  EXPECT_TRUE(is_old(memory.ram) || is_new(memory.ram));
  const auto after_first = memory.ram;
  const AfterCrash second(memory, path);
  EXPECT_EQ(second.outcome, WriteOutcome::read);
  EXPECT_EQ(memory.ram, after_first);
  EXPECT_EQ(second.stores, 0);
}

INSTANTIATE_TEST_SUITE_P(Moments, EveryCrash,
                         testing::Combine(testing::Range(0, 12), testing::Bool(), testing::Bool(),
                                          testing::Values(Mishap::none, Mishap::half_written)));

/// Leaves during the jobs of these numbers, once each, and is configured anew for so long.
struct Leaving : FakeController {
  explicit Leaving(Memory& all) : FakeController(all), memory(all) {}
  drivers::ControllerState state() const override {
    if (now < absent_until) return drivers::ControllerState::absent;
    return now < back_at ? drivers::ControllerState::configuring : drivers::ControllerState::disabled;
  }
  bool at_rest() const override { return now >= back_at + rest_known_after; }
  Result<void> start_read_parameters(double t) override {
    return begin(t) ? FakeController::start_read_parameters(t) : not_configured();
  }
  Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>& values, double t) override {
    if (begin(t) && !at_rest()) return Error{ErrorCode::refused, "wheels are turning", "", ""};
    return state() == kThere ? FakeController::start_write_parameters(values, t) : not_configured();
  }
  Result<void> start_store(double t) override {
    return begin(t) ? FakeController::start_store(t) : not_configured();
  }
  std::optional<ParameterJobResult> take_job_result() override {
    auto result = FakeController::take_job_result();
    if (!result || !leaves_during.contains(jobs - 1)) return result;
    leaves_during.erase(jobs - 1);
    absent_until = now + absent;
    back_at = absent_until + configuring;
    if (restarts) memory.power_cycle();
    result->error = Error{ErrorCode::write_unknown, "controller was lost during the job", "", ""};
    return result;
  }
  WriteReport write_to_the_end() {
    const TemporaryFolder folder;
    Journal journal = value_of(Journal::open(folder / "journal"));
    Transaction transaction(journal);
    EXPECT_TRUE(transaction.write("apply", kNew).ok());
    for (now = 0.0; now < 300.0; now += 0.01) {
      transaction.step(*this, now, 1);
      if (auto report = transaction.take_report()) return *report;
    }
    ADD_FAILURE() << "no end";
    return {};
  }

  static constexpr auto kThere = drivers::ControllerState::disabled;
  std::set<int> leaves_during;
  double absent = 0.1, configuring = 1.0, rest_known_after = 0.0;  // s
  bool restarts = false;
  double now = 0.0, absent_until = -1e9, back_at = -1e9;
  Memory& memory;

 private:
  bool begin(double t) {
    now = t;
    return state() == kThere;
  }
  static Result<void> not_configured() {
    return Error{ErrorCode::refused, "controller is not configured", "", ""};
  }
};

// Jobs of a write-back whose store is lost: 0 read, 1 write, 2 store, 3 the old values, 4 their store, 5 the
// reading of them.
constexpr int kStoreNew = 2, kWriteOld = 3, kStoreOld = 4, kReadOld = 5;

TEST(Transaction, waits_for_a_controller_that_leaves_during_any_job_of_the_way_back) {
  for (const int job : {kWriteOld, kStoreOld, kReadOld})
    for (const bool restarts : {false, true}) {
      Memory memory;
      Leaving controller(memory);
      controller.leaves_during = {kStoreNew, job};
      controller.restarts = restarts;
      EXPECT_EQ(controller.write_to_the_end().outcome, WriteOutcome::rolled_back) << job;
      EXPECT_TRUE(is_old(memory.ram) && is_old(memory.stored)) << job;
      EXPECT_LE(controller.stores, 3) << job;
    }
}

TEST(Transaction, waits_three_times_for_a_controller_that_leaves_again) {
  for (const int times : {3, 4}) {
    Memory memory;
    Leaving controller(memory);
    controller.leaves_during = {kStoreNew};
    for (int i = 0; i < times; ++i) controller.leaves_during.insert(kWriteOld + i);
    EXPECT_EQ(controller.write_to_the_end().outcome,
              times == 3 ? WriteOutcome::rolled_back : WriteOutcome::unknown);
  }
}

TEST(Transaction, waits_five_seconds_for_a_controller_that_is_silent_and_35_for_one_that_answers) {
  struct Case {
    double absent, configuring;
    WriteOutcome end;
  };
  for (const Case& one :
       {Case{4.9, 0.0, WriteOutcome::rolled_back}, Case{5.1, 0.0, WriteOutcome::unknown},
        Case{0.1, 34.8, WriteOutcome::rolled_back}, Case{0.1, 35.0, WriteOutcome::unknown}}) {
    Memory memory;
    Leaving controller(memory);
    controller.leaves_during = {kStoreNew};
    controller.absent = one.absent;
    controller.configuring = one.configuring;
    EXPECT_EQ(controller.write_to_the_end().outcome, one.end) << one.absent << ", " << one.configuring;
  }
}

TEST(Transaction, waits_for_rest_from_when_the_controller_is_back) {
  for (const double until_rest : {1.9, 2.1}) {
    Memory memory;
    Leaving controller(memory);
    controller.leaves_during = {kStoreNew};
    controller.configuring = 4.0;
    controller.rest_known_after = until_rest;
    EXPECT_EQ(controller.write_to_the_end().outcome,
              until_rest < 2.0 ? WriteOutcome::rolled_back : WriteOutcome::unknown);
  }
}

/// Says that it took all values, and took all but one.
struct TakesAllButOne : FakeController {
  using FakeController::FakeController;
  Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>& values,
                                      double now) override {
    auto taken = values;
    std::erase_if(taken, [](const auto& value) { return value.quantity == "track_width"; });
    return FakeController::start_write_parameters(taken, now);
  }
};

TEST(Transaction, a_value_that_was_not_taken_is_found_before_anything_is_stored) {
  WriteBackBench<TakesAllButOne> bench;
  EXPECT_EQ(bench.write().outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(bench.controller.stores, 0);
  EXPECT_TRUE(bench.all_old());
}

/// Comes back from its first store with one old value.
struct ForgetsInTheStore : FakeController {
  explicit ForgetsInTheStore(Memory& memory) : FakeController(memory), all(memory) {}
  Result<void> start_store(double now) override {
    if (stores == 0) all.ram["track_width"] = 400000;
    return FakeController::start_store(now);
  }
  Memory& all;
};

TEST(Transaction, a_value_that_the_store_lost_is_found_after_it) {
  WriteBackBench<ForgetsInTheStore> bench;
  EXPECT_EQ(bench.write().outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(bench.all_old());
}

TEST(Transaction, waits_for_a_store_as_long_as_the_driver_does) {
  WriteBackBench<> bench;
  ASSERT_TRUE(bench.transaction.write("apply", kNew).ok());
  EXPECT_FALSE(run(bench.transaction, bench.controller, 3));  // up to the store
  ASSERT_EQ(bench.controller.stores, 1);
  bench.controller.silent_steps = 6000;  // 60 s
  EXPECT_EQ(run(bench.transaction, bench.controller, 7000).value().outcome, WriteOutcome::committed);
}

/// Gives the result of a store first.
struct Late : FakeController {
  using FakeController::FakeController;
  std::optional<ParameterJobResult> take_job_result() override {
    if (!std::exchange(given, true)) return ParameterJobResult{ParameterJobResult::Kind::store, {}, {}};
    return FakeController::take_job_result();
  }
  bool given = false;
};

TEST(Transaction, does_not_take_the_result_of_a_store_for_its_read) {
  WriteBackBench<Late> bench;
  EXPECT_EQ(bench.write().before.size(), 3U);
  EXPECT_TRUE(is_new(bench.memory.stored));
}

/// Takes no value, the old ones neither.
struct Refusing : FakeController {
  using FakeController::FakeController;
  Mishap first = Mishap::abort;  ///< at the first write
  Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>& values,
                                      double now) override {
    fail_at = jobs;
    mishap = jobs == 1 ? first : Mishap::abort;
    return FakeController::start_write_parameters(values, now);
  }
};

TEST(Transaction, old_values_that_were_never_lost_need_not_be_written_back) {
  WriteBackBench<Refusing> bench;
  const auto report = bench.write();
  EXPECT_EQ(report.outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(report.error->code, ErrorCode::write_failed);
  EXPECT_FALSE(bench.journal.unfinished());
}

TEST(Transaction, asks_for_an_operator_when_neither_set_can_be_reached) {
  WriteBackBench<Refusing> bench;
  bench.controller.first = Mishap::half_written;
  const auto report = bench.write();
  EXPECT_EQ(report.outcome, WriteOutcome::unknown);
  EXPECT_EQ(report.error->code, ErrorCode::write_unknown);
  EXPECT_TRUE(bench.journal.unfinished());
}

}  // namespace
}  // namespace odomcalib::writeback_test
