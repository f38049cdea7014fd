#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "daemon/writeback/transaction.hpp"

namespace odomcalib {
namespace {

using drivers::ParameterJobResult;
using drivers::StoredParameter;

struct Folder {
  Folder() {
    std::string name = "/tmp/odomcalib-test-XXXXXX";
    path = mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

// Three lengths in micrometres in RAM and in permanent memory; what goes wrong is chosen by action number.
struct Memory {
  std::map<std::string, std::int64_t> ram{
      {"left_wheel_diameter", 150000}, {"right_wheel_diameter", 150000}, {"track_width", 400000}};
  std::map<std::string, std::int64_t> stored = ram;
  void power_cycle() { ram = stored; }
};

enum class Mishap { none, abort, wrong_readback, half_written };

class FakeController : public drivers::Controller {
 public:
  explicit FakeController(Memory& memory) : memory_(memory) {}
  int fail_at = -1;  // number of the job that fails
  Mishap mishap = Mishap::none;
  int jobs = 0;
  int stores = 0;

  void on_frame(const drivers::CanFrame&) override {}
  void on_time(double) override {}
  std::vector<drivers::CanFrame> take_frames() override { return {}; }
  std::vector<TickSample> take_ticks() override { return {}; }
  std::vector<drivers::ControllerEvent> take_events() override { return {}; }
  drivers::ControllerState state() const override { return drivers::ControllerState::disabled; }
  void enable(double) override {}
  void disable(double) override {}
  Result<void> command(double, double, double) override { return {}; }
  void quick_stop(double) override {}
  bool watchdog_armed() const override { return true; }
  std::optional<drivers::Identity> identity() const override { return std::nullopt; }
  bool at_rest() const override { return true; }
  RobotDescription description() const override { return {}; }
  drivers::Counters counters() const override { return {}; }
  std::vector<drivers::Capability> capabilities() const override {
    std::vector<drivers::Capability> all = drivers::host_capabilities();
    for (auto& one : all) one.readable = one.writable = one.stored = !ram_only;
    return all;
  }
  bool ram_only = false;

  Result<void> start_read_parameters(double) override {
    begin(ParameterJobResult::Kind::read);
    if (!result_->error) result_->parameters = reading();
    return {};
  }
  Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>& values, double) override {
    const Mishap now = begin(ParameterJobResult::Kind::write);
    const std::size_t count = now == Mishap::half_written ? 1 : now == Mishap::abort ? 0 : values.size();
    for (std::size_t i = 0; i < std::min(count, values.size()); ++i)
      memory_.ram[values[i].quantity] = std::llround(values[i].value * 1e6);
    result_->parameters = reading();
    if (now == Mishap::wrong_readback) result_->parameters[0].value += 1e-3;
    return {};
  }
  Result<void> start_store(double) override {
    const Mishap now = begin(ParameterJobResult::Kind::store);
    ++stores;
    if (now != Mishap::abort) memory_.stored = memory_.ram;
    return {};
  }
  std::optional<ParameterJobResult> take_job_result() override {
    return std::exchange(result_, std::nullopt);
  }

 private:
  Mishap begin(ParameterJobResult::Kind kind) {
    result_ = ParameterJobResult{};
    result_->kind = kind;
    const Mishap now = jobs++ == fail_at ? mishap : Mishap::none;
    if (now == Mishap::abort || now == Mishap::half_written)
      result_->error = Error{ErrorCode::device, "abort", "sdo", ""};
    return now;
  }
  std::vector<StoredParameter> reading() const {
    std::vector<StoredParameter> list;
    for (const auto& [name, raw] : memory_.ram)
      list.push_back({name, raw, static_cast<double>(raw) * 1e-6, 1e-6});
    return list;
  }
  Memory& memory_;
  std::optional<ParameterJobResult> result_;
};

const ParameterMap kNew{
    {"left_wheel_diameter", 0.1512345}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4021}};

bool is_old(const std::map<std::string, std::int64_t>& set) {
  return set.at("left_wheel_diameter") == 150000 && set.at("right_wheel_diameter") == 150000 &&
         set.at("track_width") == 400000;
}
bool is_new(const std::map<std::string, std::int64_t>& set) {
  return std::abs(set.at("left_wheel_diameter") - 151234) <= 1 && set.at("right_wheel_diameter") == 149800 &&
         set.at("track_width") == 402100;
}

// At most `steps` steps, then the power of the daemon fails.
std::optional<WriteReport> run(Transaction& transaction, FakeController& controller, int steps = 1000) {
  for (int i = 0; i < steps; ++i) {
    transaction.step(controller, 0.01 * i, 1);
    if (auto report = transaction.take_report()) return report;
  }
  return std::nullopt;
}

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

TEST(Journal, keeps_records_and_drops_a_torn_end) {
  const Folder folder;
  const auto path = folder.path / "journal";
  {
    auto journal = Journal::open(path);
    ASSERT_TRUE(journal.ok());
    JournalRecord record;
    record.state = JournalState::write;
    record.before = {{"track_width", 0.4}};
    ASSERT_TRUE(journal.value().append(record).ok());
    record.state = JournalState::store_begin;
    ASSERT_TRUE(journal.value().append(record).ok());
  }
  const auto size = std::filesystem::file_size(path);
  for (std::uintmax_t cut = size - 1; cut > size / 2 + 4; --cut) {
    std::filesystem::resize_file(path, cut);
    auto journal = Journal::open(path);
    ASSERT_TRUE(journal.ok());
    ASSERT_TRUE(journal.value().last().has_value()) << cut;
    EXPECT_EQ(journal.value().last()->state, JournalState::write) << cut;
    EXPECT_EQ(journal.value().last()->before.at("track_width"), 0.4);
  }
}

TEST(Journal, rejects_every_flipped_bit) {
  JournalRecord record;
  record.after = {{"track_width", 0.4}};
  std::string line = to_line(record);
  line.pop_back();
  ASSERT_TRUE(from_line(line).has_value());
  for (std::size_t i = 0; i < line.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = line;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      EXPECT_FALSE(from_line(damaged).has_value()) << i << " " << bit;
    }
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

TEST(Transaction, asks_for_an_operator_when_neither_set_can_be_reached) {
  const Folder folder;
  Memory memory;
  auto journal = Journal::open(folder.path / "journal");
  struct Stubborn : FakeController {
    using FakeController::FakeController;
    Result<void> start_write_parameters(const std::vector<drivers::ParameterValue>& values,
                                        double now) override {
      fail_at = jobs;
      mishap = Mishap::half_written;
      return FakeController::start_write_parameters(values, now);
    }
  } controller(memory);
  Transaction transaction(journal.value());
  ASSERT_TRUE(transaction.write("apply", kNew).ok());
  const auto report = run(transaction, controller);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->outcome, WriteOutcome::unknown);
  EXPECT_EQ(report->error->code, ErrorCode::write_unknown);
  EXPECT_TRUE(journal.value().unfinished().has_value());
}

TEST(History, keeps_the_newest_fifty_newest_first) {
  const Folder folder;
  History history(folder.path / "history");
  for (int i = 0; i < 60; ++i) {
    HistoryEntry entry;
    entry.time = i;
    entry.action = "apply";
    entry.calibration = R"({"format":"x"})";
    ASSERT_TRUE(history.add(entry).ok());
  }
  const auto entries = history.entries();
  ASSERT_EQ(entries.size(), History::kKept);
  EXPECT_EQ(entries.front().time, 59);
  EXPECT_EQ(entries.front().id, "0060");
  ASSERT_TRUE(history.find("0060").has_value());
  EXPECT_EQ(*history.find("0060")->calibration, R"({"format":"x"})");
  EXPECT_FALSE(history.find("0001").has_value());
}

}  // namespace
}  // namespace odomcalib
