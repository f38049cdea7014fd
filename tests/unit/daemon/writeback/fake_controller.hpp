// A controller that holds three lengths, whose jobs fail where a test wants them to.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/writeback/journal.hpp"
#include "daemon/writeback/transaction.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib {

using drivers::ParameterJobResult;
using drivers::StoredParameter;

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
  double watchdog_time() const override { return 0.2; }
  std::optional<drivers::Identity> identity() const override { return who; }
  bool at_rest() const override { return rests; }
  RobotDescription description() const override { return {}; }
  drivers::Counters counters() const override { return {}; }
  std::vector<drivers::Capability> capabilities() const override {
    std::vector<drivers::Capability> all = drivers::host_capabilities();
    for (auto& one : all) one.readable = one.writable = one.stored = !ram_only;
    return all;
  }
  bool ram_only = false;
  bool rests = true;
  std::optional<drivers::Identity> who;
  int silent_steps = 0;  // how often it is asked before it gives a result

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
    if (silent_steps > 0 && silent_steps-- > 0) return std::nullopt;
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

inline const ParameterMap kNew{
    {"left_wheel_diameter", 0.1512345}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4021}};

inline bool is_old(const std::map<std::string, std::int64_t>& set) {
  return set.at("left_wheel_diameter") == 150000 && set.at("right_wheel_diameter") == 150000 &&
         set.at("track_width") == 400000;
}
inline bool is_new(const std::map<std::string, std::int64_t>& set) {
  return std::abs(set.at("left_wheel_diameter") - 151234) <= 1 && set.at("right_wheel_diameter") == 149800 &&
         set.at("track_width") == 402100;
}

// At most `steps` steps, then the power of the daemon fails.
inline std::optional<WriteReport> run(Transaction& transaction, FakeController& controller,
                                      int steps = 1000) {
  for (int i = 0; i < steps; ++i) {
    transaction.step(controller, 0.01 * i, 1);
    if (auto report = transaction.take_report()) return report;
  }
  return std::nullopt;
}

/// A controller, its journal and a transaction on both.
template <typename Controller = FakeController>
struct WriteBackBench {
  const TemporaryFolder folder;
  Memory memory;
  Controller controller{memory};
  Journal journal = value_of(Journal::open(folder / "journal"));
  Transaction transaction{journal};

  /// Ends the test where no report comes.
  WriteReport finish() { return run(transaction, controller).value(); }
  WriteReport write(const ParameterMap& values = kNew, Proof proof = Proof::none) {
    EXPECT_TRUE(transaction.write("apply", values, "", proof).ok());
    return finish();
  }
  WriteReport recover() {
    EXPECT_TRUE(transaction.recover().ok());
    return finish();
  }
  [[nodiscard]] bool all_old() const { return is_old(memory.ram) && is_old(memory.stored); }
  [[nodiscard]] bool all_new() const { return is_new(memory.ram) && is_new(memory.stored); }
};

/// Further damage by a crash: the controller loses its power, the last record of the journal is torn.
inline void lose(Memory& memory, const std::filesystem::path& journal, bool power, bool end_of_record) {
  if (power) memory.power_cycle();
  if (end_of_record && std::filesystem::file_size(journal) > 3)
    std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 3);
}

/// Recovery by the next daemon: values all of one set, both memories alike, and the journal ended.
struct AfterCrash {
  AfterCrash(Memory& memory, const std::filesystem::path& path) {
    FakeController controller(memory);
    auto journal = value_of(Journal::open(path));
    Transaction transaction(journal);
    EXPECT_TRUE(transaction.recover().ok());
    outcome = run(transaction, controller).value().outcome;
    stores = controller.stores;
    EXPECT_NE(outcome, WriteOutcome::unknown);
    EXPECT_EQ(memory.ram, memory.stored);
    EXPECT_FALSE(journal.unfinished());
  }
  WriteOutcome outcome{};
  int stores = 0;
};

inline const ParameterMap kOld{
    {"left_wheel_diameter", 0.15}, {"right_wheel_diameter", 0.15}, {"track_width", 0.4}};

inline JournalRecord record_of(JournalState state) {
  JournalRecord record;
  record.state = state;
  record.label = "apply";
  record.before = kOld;
  record.after = kNew;
  record.store_begun = state == JournalState::store_begin || state == JournalState::needs_operator;
  return record;
}

}  // namespace odomcalib
