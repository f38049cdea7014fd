#include "daemon/writeback/transaction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/writeback/settings.hpp"

namespace odomcalib {
namespace {

const drivers::StoredParameter* find(const std::vector<drivers::StoredParameter>& stored,
                                     const std::string& name) {
  const auto found =
      std::find_if(stored.begin(), stored.end(), [&](const auto& p) { return p.quantity == name; });
  return found == stored.end() ? nullptr : &*found;
}

ParameterMap map_of(const std::vector<drivers::StoredParameter>& stored) {
  ParameterMap map;
  for (const auto& parameter : stored) map[parameter.quantity] = parameter.value;
  return map;
}

std::vector<drivers::ParameterValue> list_of(const ParameterMap& map) {
  std::vector<drivers::ParameterValue> list;
  for (const auto& [name, value] : map) list.push_back({name, value});
  return list;
}

// Only what the controller has a place for.
ParameterMap common(const ParameterMap& wanted, const ParameterMap& present) {
  ParameterMap out;
  for (const auto& [name, value] : wanted)
    if (present.contains(name)) out[name] = value;
  return out;
}

/// Some controllers hold values in RAM only: there is nothing to store then.
bool stores_any(const drivers::Controller& controller, const ParameterMap& values) {
  const auto all = controller.capabilities();
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& one) { return one.stored && values.contains(one.quantity); });
}

bool names_all(const ParameterMap& values, const ParameterMap& wanted) {
  return std::all_of(wanted.begin(), wanted.end(),
                     [&](const auto& one) { return values.contains(one.first); });
}

/// On the way to the new values, with nothing left to do but to store them or to say so.
bool nearly_done(const JournalRecord& record) {
  return record.state == JournalState::store_begin || record.state == JournalState::store_ok;
}

Error mixture(const JournalRecord& interrupted) {
  return {
      ErrorCode::refused,
      "an interrupted " + interrupted.label + " may have left a mixture, and not all of its values are given",
      "write-back", "apply a whole calibration, set all values, or roll back"};
}

Error other_device(const std::string& journaled, const std::string& found) {
  return {ErrorCode::write_unknown,
          fmt::format("the interrupted write-back was to \"{}\", this controller is \"{}\": nothing was "
                      "written to it",
                      journaled, found),
          "recovery", "connect that controller, or apply a calibration to this one"};
}

Error nothing_to_compare() {
  return {ErrorCode::write_unknown, "the journal does not say which values were in force", "recovery",
          "see odomcalibctl params get, then apply a calibration or roll back to an entry of the history"};
}

/// The others tell of what has happened: where they are missing, the comparison at the next start finds out.
bool must_be_written(JournalState state) {
  return state == JournalState::begin || state == JournalState::write || state == JournalState::readback_ok ||
         state == JournalState::proof_ok || state == JournalState::store_begin;
}

Error mismatch(const char* when) {
  return {ErrorCode::write_failed, fmt::format("the controller holds other values than written ({})", when),
          "controller parameters", "try again; check the parameter map of the profile"};
}

}  // namespace

std::string device_of(const drivers::Controller& controller) {
  std::string all;
  for (const drivers::Identity& one : controller.devices()) {
    const bool numbered = one.vendor != 0 || one.product != 0 || one.serial != 0;
    all += all.empty() ? "" : " + ";
    all += numbered ? fmt::format("{:#x}/{:#x}/{}", one.vendor, one.product, one.serial) : one.name;
  }
  return all;
}

bool holds(const std::vector<drivers::StoredParameter>& stored, const ParameterMap& wanted) {
  return !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), [&](const auto& entry) {
    const auto* parameter = find(stored, entry.first);
    return parameter != nullptr &&
           std::abs(parameter->value - entry.second) <=
               writeback::settings::kSameStep * parameter->step + writeback::settings::kSame_m;
  });
}

Result<void> Transaction::begin(Task task, const std::string& label) {
  if (busy()) return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  report_ = {};
  report_.label = label;
  task_ = task;
  interrupted_ = journal_.unfinished();
  store_begun_ = false;
  stored_again_ = false;
  old_known_ = true;
  unproven_ = false;
  returns_ = 0;
  proof_.reset();
  phase_ = Phase::read_first;
  started_ = false;
  return {};
}

Result<void> Transaction::read() { return begin(Task::read, "read"); }
Result<void> Transaction::recover() { return begin(Task::recover, "recovery"); }

Result<void> Transaction::write(const std::string& label, const ParameterMap& values,
                                const std::string& calibration, Proof proof, const Provenance& origin) {
  for (const auto& [name, value] : values)
    if (!std::isfinite(value) || value <= 0.0)
      return Error{ErrorCode::refused, fmt::format("{} = {} is no length", name, value), label,
                   "solve again"};
  if (auto begun = begin(Task::write, label); !begun) return begun;
  report_.after = values;
  report_.calibration = calibration;
  report_.origin = origin;
  unproven_ = proof == Proof::wanted;
  return {};
}

Result<void> Transaction::conclude(const Result<void>& proof, const DriveTrial& trial) {
  if (!proving())
    return Error{ErrorCode::refused, "no values wait for a proof", "write-back", "odomcalibctl params get"};
  proof_ = proof;
  report_.origin.trial = trial;
  return {};
}

JournalRecord Transaction::record_of(JournalState state) const {
  return {.seq = 0,
          .monotonic = now_,
          .wall_us = wall_us_,
          .state = state,
          .label = report_.label,
          .before = report_.before,
          .after = report_.after,
          .device = report_.device,
          .calibration = report_.calibration,
          .store_begun = store_begun_ || state == JournalState::store_begin,
          .unproven = unproven_,
          .origin = report_.origin};
}

void Transaction::announce(std::deque<JournalState> states, After after) {
  announced_ = std::move(states);
  after_ = after;
  announcing_ = true;
  if (!announced_.empty()) journal_.append(record_of(announced_.front()));
  go_on_announcing();
}

void Transaction::go_on_announcing() {
  while (!announced_.empty()) {
    const auto written = journal_.take_result();
    if (!written) return;  // the disk takes its time
    const JournalState state = announced_.front();
    announced_.pop_front();
    if (*written) report_.steps.push_back(name_of(state));
    if (!*written && must_be_written(state)) return not_announced(written->error());
    if (!announced_.empty()) journal_.append(record_of(announced_.front()));
  }
  announcing_ = false;
  proceed(after_);
}

/// The announced step must not happen: nothing has been touched yet, or everything goes back.
void Transaction::not_announced(const Error& why) {
  announced_.clear();
  announcing_ = false;
  const bool touched = phase_ == Phase::write_new || phase_ == Phase::proving;
  return touched ? go_back(why) : not_begun(why);
}

void Transaction::proceed(After after) {
  switch (after) {
    case After::write_new:
      return start(Phase::write_new);
    case After::prove:
      phase_ = Phase::proving;
      report_.outcome = WriteOutcome::proving;
      finished_ = report_;
      return;
    case After::store_new:
      store_begun_ = true;
      return start(Phase::store_new);
    case After::commit:
      return finish(WriteOutcome::committed);
    case After::write_old:
      return start(Phase::write_old);
    case After::report:
      return report();
  }
}

drivers::ParameterJobResult::Kind Transaction::kind() const {
  switch (phase_) {
    case Phase::write_new:
    case Phase::write_old:
      return Job::Kind::write;
    case Phase::store_new:
    case Phase::store_old:
      return Job::Kind::store;
    default:
      return Job::Kind::read;
  }
}

Result<void> Transaction::start_job() const {
  switch (kind()) {
    case Job::Kind::read:
      return controller_->start_read_parameters(now_);
    case Job::Kind::write:
      return controller_->start_write_parameters(
          list_of(phase_ == Phase::write_new ? report_.after : report_.before), now_);
    case Job::Kind::store:
      return controller_->start_store(now_);
  }
  return {};
}

void Transaction::start(Phase phase) {
  phase_ = phase;
  entered_ = now_;
  away_ = now_;
  answered_ = now_;
  started_ = false;
  start_when_at_rest();
}

/// On the way back it is waited for: what it holds is read before motion is forbidden. On the way forth a
/// controller that has left has lost the new values, or will.
bool Transaction::controller_there() const {
  const bool way_back =
      phase_ == Phase::write_old || phase_ == Phase::store_old || phase_ == Phase::verify_old;
  const auto state = controller_->state();
  return !way_back ||
         (state != drivers::ControllerState::absent && state != drivers::ControllerState::configuring);
}

/// A controller that answers is waited for longer: its set-up is many requests, and each may be late.
bool Transaction::waits_for_controller() {
  if (controller_there()) return false;
  away_ = now_;
  if (controller_->state() == drivers::ControllerState::configuring) answered_ = now_;
  return now_ - answered_ < writeback::settings::kWaitForController_s &&
         now_ - entered_ < writeback::settings::kWaitForSetUp_s;
}

/// A controller that left during a job of the way back, and not one that refuses it, is waited for once more.
bool Transaction::again_when_back(const Job& job, Phase phase) {
  const bool refused = job.error && job.error->code == ErrorCode::refused;
  if (controller_there() || refused || returns_ >= writeback::settings::kMostReturns) return false;
  ++returns_;
  start(phase);
  return true;
}

void Transaction::start_when_at_rest() {
  if (waits_for_controller()) return;
  const bool needs_rest = kind() != Job::Kind::read && controller_there();
  if (needs_rest && !controller_->at_rest() && now_ - away_ < writeback::settings::kWaitForRest_s) return;
  started_ = true;
  if (auto begun = start_job(); !begun) {
    Job job;
    job.error = begun.error();
    on_result(job);
  }
}

void Transaction::step(drivers::Controller& controller, double now, std::int64_t wall_us) {
  controller_ = &controller;
  now_ = now;
  wall_us_ = wall_us;
  if (phase_ == Phase::idle) return;
  if (announcing_) return go_on_announcing();
  if (phase_ == Phase::proving) return on_proof();
  if (!started_) return start_when_at_rest();
  // The driver bounds the time of its jobs: it knows how long a store may take.
  const auto result = controller_->take_job_result();
  if (result && result->kind == kind()) on_result(*result);
}

void Transaction::on_result(const Job& job) {
  switch (phase_) {
    case Phase::read_first:
      return on_read(job);
    case Phase::write_new:
      return on_written(job);
    case Phase::store_new:
      if (job.error) return go_back(*job.error);
      return start(Phase::verify_new);
    case Phase::verify_new:
      return on_verified(job);
    case Phase::write_old:
      return on_old_written(job);
    case Phase::store_old:
      if (!job.error) return start(Phase::verify_old);
      // A lost answer must not be the reason why nobody knows what is stored. Where the controller left, it
      // may have restarted: its RAM holds what was stored then, and that may be the new values.
      if (!std::exchange(stored_again_, true))
        return again_when_back(job, Phase::write_old) ? void() : start(Phase::store_old);
      report_.error = *job.error;
      return finish(WriteOutcome::unknown);
    case Phase::verify_old:
      return on_old_verified(job);
    case Phase::idle:
    case Phase::proving:
      return;
  }
}

void Transaction::on_read(const Job& job) {
  if (job.error) return not_begun(*job.error);
  report_.in_force = job.parameters;
  report_.device = device_of(*controller_);
  if (task_ == Task::read) return finish(WriteOutcome::read);
  if (task_ == Task::recover) return decide_recovery();
  plan_write();
}

/// Nothing was touched: what was in force still is. After an interrupted write-back nobody knows what that
/// is.
void Transaction::not_begun(const Error& why) {
  report_.error = why;
  if (task_ != Task::write) return finish(WriteOutcome::read);
  finish(interrupted_ ? WriteOutcome::unknown : WriteOutcome::rolled_back);
}

bool Transaction::about_this_device() const {
  return interrupted_ && (interrupted_->device.empty() || interrupted_->device == report_.device);
}

void Transaction::plan_write() {
  const ParameterMap present = map_of(report_.in_force);
  report_.before = common(present, report_.after);
  report_.after = common(report_.after, report_.before);
  if (about_this_device()) {
    const ParameterMap& doubtful = interrupted_->before.empty() ? present : interrupted_->before;
    if (!names_all(report_.after, doubtful)) return not_begun(mixture(*interrupted_));
    take_old_from_journal();
  }
  begin_writing();
}

/// The values read may be a mixture that nobody ever wanted. They must not become the values to go back to.
void Transaction::take_old_from_journal() {
  store_begun_ = interrupted_->store_begun;
  const bool new_in_force = nearly_done(*interrupted_) && holds(report_.in_force, interrupted_->after);
  old_known_ = new_in_force || !interrupted_->before.empty();
  if (new_in_force) return;
  for (const auto& [name, value] : common(interrupted_->before, report_.before)) report_.before[name] = value;
}

void Transaction::begin_writing() {
  // Values that have no place in a controller stay on the host: nothing that a crash could leave half done.
  if (report_.after.empty()) return finish(WriteOutcome::committed);
  announce({JournalState::begin, JournalState::write}, After::write_new);
}

void Transaction::on_written(const Job& job) {
  if (job.error) return go_back(*job.error);
  if (!holds(job.parameters, report_.after)) return go_back(mismatch("read back"));
  report_.in_force = job.parameters;
  if (unproven_) return announce({JournalState::readback_ok}, After::prove);
  keep({JournalState::readback_ok});
}

void Transaction::on_proof() {
  if (!proof_) return;
  if (!*proof_) return go_back(proof_->error());
  unproven_ = false;
  report_.origin.proven = true;
  keep({JournalState::proof_ok});
}

/// Stores what RAM holds, where there is something to store it in.
void Transaction::keep(std::deque<JournalState> states) {
  const bool stored = stores_any(*controller_, report_.after);
  if (stored) states.push_back(JournalState::store_begin);
  announce(std::move(states), stored ? After::store_new : After::commit);
}

void Transaction::on_verified(const Job& job) {
  if (job.error) return go_back(*job.error);
  if (!holds(job.parameters, report_.after)) return go_back(mismatch("after the store"));
  report_.in_force = job.parameters;
  // The store is done: a journal that cannot be written now is repaired by the comparison at the next start.
  announce({JournalState::store_ok}, After::commit);
}

void Transaction::go_back(const Error& why) {
  if (!report_.error) report_.error = Error{ErrorCode::write_failed, why.what, why.where, why.remedy};
  announce({JournalState::rollback}, After::write_old);
}

void Transaction::on_old_written(const Job& job) {
  const bool restored = !job.error && holds(job.parameters, report_.before);
  if (!restored && again_when_back(job, Phase::write_old)) return;
  // A controller that refuses its old values may never have lost them: that is seen, not concluded.
  if (!restored && !store_begun_) return start(Phase::verify_old);
  if (!restored) return finish(WriteOutcome::unknown);
  report_.in_force = job.parameters;
  const bool stored = store_begun_ && stores_any(*controller_, report_.before);
  if (stored) return start(Phase::store_old);
  finish(WriteOutcome::rolled_back);
}

void Transaction::on_old_verified(const Job& job) {
  const bool good = !job.error && holds(job.parameters, report_.before);
  if (!good && again_when_back(job, Phase::verify_old)) return;
  if (good) report_.in_force = job.parameters;
  finish(good ? WriteOutcome::rolled_back : WriteOutcome::unknown);
}

// By comparison, not by memory: the journal says only which two sets to compare with, and whose they are.
void Transaction::decide_recovery() {
  if (!interrupted_) return finish(WriteOutcome::read);
  if (!about_this_device()) return leave_alone(other_device(interrupted_->device, report_.device));
  report_.label = interrupted_->label;
  report_.before = interrupted_->before;
  report_.after = interrupted_->after;
  report_.calibration = interrupted_->calibration;
  report_.origin = interrupted_->origin;
  store_begun_ = interrupted_->store_begun;
  const bool forward = interrupted_->state != JournalState::rollback && !interrupted_->unproven;
  if (forward && holds(report_.in_force, report_.after)) return store_again();
  if (report_.before.empty()) return leave_alone(nothing_to_compare());
  if (holds(report_.in_force, report_.before) && !store_begun_) return finish(WriteOutcome::rolled_back);
  go_back({ErrorCode::write_failed, "an interrupted write-back was undone", "recovery", "apply again"});
}

/// RAM holds the new set; whether it was stored cannot be seen, storing again is harmless.
void Transaction::store_again() {
  if (!stores_any(*controller_, report_.after)) return finish(WriteOutcome::committed);
  announce({JournalState::store_begin}, After::store_new);
}

void Transaction::leave_alone(const Error& why) {
  report_.error = why;
  finish(WriteOutcome::unknown);
}

void Transaction::finish(WriteOutcome outcome) {
  if (outcome == WriteOutcome::rolled_back && !old_known_) outcome = WriteOutcome::unknown;
  report_.outcome = outcome;
  std::deque<JournalState> last;
  if (outcome == WriteOutcome::committed) last = {JournalState::commit};
  if (outcome == WriteOutcome::rolled_back && !report_.before.empty()) last = {JournalState::rolled_back};
  if (outcome == WriteOutcome::unknown) {
    // The journal goes on saying what it said unless there was something new to say.
    if (!report_.steps.empty()) last = {JournalState::needs_operator};
    if (!report_.error) report_.error = mismatch("after restoring");
    report_.error->code = ErrorCode::write_unknown;
  }
  announce(std::move(last), After::report);
}

void Transaction::report() {
  finished_ = report_;
  phase_ = Phase::idle;
  started_ = false;
}

std::optional<WriteReport> Transaction::take_report() { return std::exchange(finished_, std::nullopt); }

}  // namespace odomcalib
