#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::writeback_test {
namespace {

TEST(WriteBack, values_that_live_in_ram_only_are_not_stored) {
  const Folder folder;
  auto journal = Journal::open(folder.path / "journal");
  ASSERT_TRUE(journal.ok());
  Memory memory;
  FakeController controller(memory);
  controller.ram_only = true;
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->outcome, WriteOutcome::committed);
  EXPECT_EQ(controller.stores, 0);
  EXPECT_TRUE(is_new(memory.ram));
  EXPECT_FALSE(journal.value().unfinished());
}

TEST(Transaction, commits_after_one_store) {
  const Folder folder;
  Memory memory;
  FakeController controller(memory);
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::committed);
  EXPECT_TRUE(is_new(memory.ram) && is_new(memory.stored));
  EXPECT_EQ(controller.stores, 1);
  EXPECT_EQ(journal.value().last()->state, JournalState::commit);
}

TEST(Transaction, refuses_values_that_are_no_lengths) {
  const Folder folder;
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  EXPECT_FALSE(transaction.write("apply", {{"track_width", std::nan("")}}).ok());
  EXPECT_FALSE(transaction.write("apply", {{"track_width", -0.4}}).ok());
  EXPECT_TRUE(transaction.write("apply", kNew).ok());
  EXPECT_FALSE(transaction.write("apply", kNew).ok());
}

class EveryMishap : public testing::TestWithParam<std::tuple<int, Mishap>> {};

TEST_P(EveryMishap, leaves_wholly_old_or_wholly_new_values_and_says_which) {
  const auto [job, mishap] = GetParam();
  const Folder folder;
  Memory memory;
  FakeController controller(memory);
  controller.fail_at = job;
  controller.mishap = mishap;
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  ASSERT_NE(report->outcome, WriteOutcome::unknown);
  memory.power_cycle();
  if (report->outcome == WriteOutcome::committed)
    EXPECT_TRUE(is_new(memory.ram));
  else
    EXPECT_TRUE(is_old(memory.ram) && report->error.has_value());
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
  const Folder folder;
  Memory memory;
  const auto path = folder.path / "journal";
  {
    FakeController controller(memory);
    controller.fail_at = 1;
    controller.mishap = mishap;
    auto journal = Journal::open(path);
    Transaction transaction(journal.value());
    ASSERT_TRUE(transaction.write("apply", kNew).ok());
    run(transaction, controller, steps);
  }
  if (power_cycle) memory.power_cycle();
  if (torn && std::filesystem::file_size(path) > 3)
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  std::map<std::string, std::int64_t> after_first;
  for (int round = 0; round < 2; ++round) {
    FakeController controller(memory);
    auto journal = Journal::open(path);
    Transaction transaction(journal.value());
    ASSERT_TRUE(transaction.recover().ok());
    const auto report = run(transaction, controller);
    ASSERT_TRUE(report.has_value());
    EXPECT_NE(report->outcome, WriteOutcome::unknown);
    EXPECT_TRUE(is_old(memory.ram) || is_new(memory.ram));
    EXPECT_EQ(memory.ram, memory.stored);
    EXPECT_FALSE(journal.value().unfinished().has_value());
    if (round == 1) {
      EXPECT_EQ(report->outcome, WriteOutcome::read);
      EXPECT_EQ(memory.ram, after_first);
      EXPECT_EQ(controller.stores, 0);
    }
    after_first = memory.ram;
  }
}

INSTANTIATE_TEST_SUITE_P(Moments, EveryCrash,
                         testing::Combine(testing::Range(0, 12), testing::Bool(), testing::Bool(),
                                          testing::Values(Mishap::none, Mishap::half_written)));

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
  const Folder folder;
  Memory memory;
  TakesAllButOne controller(memory);
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(controller.stores, 0);
  EXPECT_TRUE(is_old(memory.ram) && is_old(memory.stored));
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
  const Folder folder;
  Memory memory;
  ForgetsInTheStore controller(memory);
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::rolled_back);
  EXPECT_TRUE(is_old(memory.ram) && is_old(memory.stored));
}

TEST(Transaction, waits_for_a_store_as_long_as_the_driver_does) {
  const Folder folder;
  Memory memory;
  FakeController controller(memory);
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  EXPECT_FALSE(run(transaction, controller, 3));  // up to the store
  ASSERT_EQ(controller.stores, 1);
  controller.silent_steps = 6000;  // 60 s
  const auto report = run(transaction, controller, 7000);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::committed);
}

TEST(Transaction, does_not_take_the_result_of_a_store_for_its_read) {
  const Folder folder;
  Memory memory;
  struct Late : FakeController {
    using FakeController::FakeController;
    std::optional<ParameterJobResult> take_job_result() override {
      if (!std::exchange(given, true)) return ParameterJobResult{ParameterJobResult::Kind::store, {}, {}};
      return FakeController::take_job_result();
    }
    bool given = false;
  } late(memory);
  auto journal = Journal::open(folder.path / "journal");
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, late);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->before.size(), 3U);
  EXPECT_TRUE(is_new(memory.stored));
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
  const Folder folder;
  Memory memory;
  auto journal = Journal::open(folder.path / "journal");
  Refusing controller(memory);
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::rolled_back);
  EXPECT_EQ(report->error->code, ErrorCode::write_failed);
  EXPECT_FALSE(journal.value().unfinished().has_value());
}

TEST(Transaction, asks_for_an_operator_when_neither_set_can_be_reached) {
  const Folder folder;
  Memory memory;
  auto journal = Journal::open(folder.path / "journal");
  Refusing controller(memory);
  controller.first = Mishap::half_written;
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::unknown);
  EXPECT_EQ(report->error->code, ErrorCode::write_unknown);
  EXPECT_TRUE(journal.value().unfinished().has_value());
}

}  // namespace
}  // namespace odomcalib::writeback_test
