#include "daemon/service/parts/write_back.hpp"

#include <algorithm>
#include <limits>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

bool away(drivers::ControllerState state) {
  return state == drivers::ControllerState::absent || state == drivers::ControllerState::configuring;
}

}  // namespace

std::string name_of(WriteOutcome outcome) {
  if (outcome == WriteOutcome::committed) return "committed";
  if (outcome == WriteOutcome::proving) return "proving";
  return outcome == WriteOutcome::rolled_back ? "rolled_back" : "unknown";
}

WriteBack::WriteBack(Journal write_journal, const std::filesystem::path& state_dir, Background& disk)
    : journal_(std::move(write_journal)),
      transaction(journal_, disk),
      history(state_dir / "history"),
      operator_needed(unfinished()),
      recovery_pause_(service::settings::kRecoverAgain_s) {}

std::optional<WriteReport> WriteBack::serve(drivers::Controller& controller, bool& values_known,
                                            bool may_begin, double now, std::int64_t wall_us) {
  const auto state = controller.state();
  was_away_ = was_away_ || away(state);
  serve_proof(state, may_begin, now);
  // What is there when it comes back, and what it holds, is to be seen, at once: nothing moves before.
  if (was_away_ && !busy()) {
    was_away_ = values_known = recovery_tried_ = false;
    if (!ending_) next_read_ = now;
  }
  if (state == drivers::ControllerState::disabled && !busy() && may_begin && now >= next_read_)
    begin_reading(controller, values_known, now);
  transaction.step(controller, now, wall_us);
  return transaction.take_report();
}

// What RAM holds is as fleeting as the one who wanted it proven: what ends the one ends the other.
void WriteBack::serve_proof(drivers::ControllerState state, bool may_begin, double now) {
  if (!transaction.proving()) {
    proof_ends_ = now + service::settings::kLongestProof_s;
    return;
  }
  if (was_away_) take_back("the controller was away");
  if (now >= proof_ends_) take_back("the proof took too long");
  if (not_proven_ && may_begin && state == drivers::ControllerState::disabled)
    (void)transaction.conclude(*not_proven_);
}

Result<void> WriteBack::store() {
  if (!not_proven_) return transaction.conclude({});
  return *not_proven_;
}

void WriteBack::take_back(const std::string& why) {
  if (transaction.busy() && prover_ && !not_proven_)
    not_proven_ = {ErrorCode::write_failed, "not proven: " + why, "proof run", "calibrate again"};
}

void WriteBack::forget(ClientId gone) {
  if (prover_ == gone) take_back("whoever drove the proof has left");
}

// One recovery each time the controller was configured: each may store once, and permanent memory wears out.
// After it only reads are repeated. It waits for rest, reading alone does not.
void WriteBack::begin_reading(const drivers::Controller& controller, bool values_known, double now) {
  const bool recover = operator_needed && !recovery_tried_ && now >= next_recovery_;
  if (recover ? !controller.at_rest() : values_known) return;
  // Who writes to it now would do so while it is read.
  if (const auto touched = controller.touched();
      touched && now - *touched < service::settings::kOthersQuiet_s)
    return;
  next_read_ = now + service::settings::kReadAgain_s;
  if (recover) {
    next_recovery_ = now + recovery_pause_;
    recovery_pause_ = std::min(2.0 * recovery_pause_, service::settings::kLongestRecoverAgain_s);
  }
  (void)(recover ? transaction.recover() : transaction.read());
}

Result<void> WriteBack::write(const std::string& label, const ParameterMap& values,
                              const std::string& calibration, std::optional<ClientId> prover) {
  if (settling) return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  auto begun = transaction.write(label, values, calibration, prover ? Proof::wanted : Proof::none);
  if (!begun) return begun;
  ended.reset();
  prover_ = prover;
  not_proven_.reset();
  return begun;
}

void WriteBack::learn(const WriteReport& report) {
  const bool unknown = report.outcome == WriteOutcome::unknown;
  recovery_tried_ = recovery_tried_ || unknown;
  if (report.outcome == WriteOutcome::committed || report.outcome == WriteOutcome::rolled_back) {
    next_recovery_ = 0.0;
    recovery_pause_ = service::settings::kRecoverAgain_s;
  }
  operator_needed = unknown || (report.outcome == WriteOutcome::read && unfinished());
  if (operator_needed && report.error) problem = report.error->text();
}

void WriteBack::end() {
  ending_ = true;
  take_back("the daemon ends");
  next_read_ = std::numeric_limits<double>::infinity();
}

std::string WriteBack::journaled_calibration() const {
  const auto& last = transaction.journal().last();
  return last ? last->calibration : "";
}

// One that was rolled back or ended unknown has put nothing in force that could be taken back.
std::optional<FormerValues> WriteBack::former_values(const std::string& id,
                                                     const std::optional<std::string>& in_force) const {
  const auto interrupted = transaction.journal().unfinished();
  if (id.empty() && interrupted && !interrupted->before.empty())
    return FormerValues{interrupted->before, in_force, interrupted->device};
  const auto entry = id.empty() ? history.newest_committed() : history.find(id);
  if (!entry) return std::nullopt;
  FormerValues former{entry->before, std::nullopt, entry->device};
  // The calibration in force before that entry is the one of the newest older entry that was committed.
  for (const auto& older : history.entries())
    if (older.id < entry->id && older.outcome == "committed" && !former.calibration)
      former.calibration = older.calibration;
  return former;
}

}  // namespace odomcalib
