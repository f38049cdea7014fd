#include "daemon/writeback/transaction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace odomcalib {
namespace {

constexpr double kJobTimeout =
    20.0;  // s: stores may take several seconds, the driver's own time-outs are shorter

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

Error mismatch(const char* when) {
  return {ErrorCode::write_failed, fmt::format("the controller holds other values than written ({})", when),
          "controller parameters", "try again; check the parameter map of the profile"};
}

}  // namespace

bool holds(const std::vector<drivers::StoredParameter>& stored, const ParameterMap& wanted) {
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& entry) {
    const auto* parameter = find(stored, entry.first);
    return parameter != nullptr && std::abs(parameter->value - entry.second) <= 0.51 * parameter->step + 1e-9;
  });
}

Result<void> Transaction::recover() {
  if (busy()) return Error{ErrorCode::refused, "another write-back is running", "", "wait for its end"};
  report_ = {};
  report_.label = "recovery";
  recovering_ = true;
  store_begun_ = false;
  phase_ = Phase::read_first;
  started_ = false;
  return {};
}

Result<void> Transaction::write(const std::string& label, const ParameterMap& values) {
  if (busy()) return Error{ErrorCode::refused, "another write-back is running", "", "wait for its end"};
  for (const auto& [name, value] : values)
    if (!std::isfinite(value) || value <= 0.0)
      return Error{ErrorCode::refused, fmt::format("{} = {} is no length", name, value), label,
                   "solve again"};
  report_ = {};
  report_.label = label;
  report_.after = values;
  recovering_ = false;
  store_begun_ = false;
  phase_ = Phase::read_first;
  started_ = false;
  return {};
}

Result<void> Transaction::announce(JournalState state) {
  auto written = journal_.append({.seq = 0,
                                  .monotonic = now_,
                                  .wall_us = wall_us_,
                                  .state = state,
                                  .label = report_.label,
                                  .before = report_.before,
                                  .after = report_.after});
  if (written) report_.steps.push_back(name_of(state));
  return written;
}

Result<void> Transaction::start_job(Phase phase, drivers::Controller& controller, double now) const {
  switch (phase) {
    case Phase::write_new:
      return controller.start_write_parameters(list_of(report_.after), now);
    case Phase::write_old:
      return controller.start_write_parameters(list_of(report_.before), now);
    case Phase::store_new:
    case Phase::store_old:
      return controller.start_store(now);
    default:
      return controller.start_read_parameters(now);
  }
}

void Transaction::start(Phase phase, drivers::Controller& controller, double now) {
  phase_ = phase;
  began_ = now;
  started_ = true;
  if (auto begun = start_job(phase, controller, now); !begun) {
    Job job;
    job.error = begun.error();
    on_result(job, controller, now);
  }
}

void Transaction::step(drivers::Controller& controller, double now, std::int64_t wall_us) {
  now_ = now;
  wall_us_ = wall_us;
  if (phase_ == Phase::idle) return;
  if (!started_) return start(phase_, controller, now);
  if (auto result = controller.take_job_result()) return on_result(*result, controller, now);
  if (now - began_ < kJobTimeout) return;
  Job job;
  job.error =
      Error{ErrorCode::timeout, "the controller does not answer", "controller parameters", "check the bus"};
  on_result(job, controller, now);
}

void Transaction::on_result(const Job& job, drivers::Controller& controller, double now) {
  switch (phase_) {
    case Phase::read_first:
      return on_read(job, controller, now);
    case Phase::write_new:
      return on_written(job, controller, now);
    case Phase::store_new:
      if (job.error) return go_back(*job.error, controller, now);
      return start(Phase::verify_new, controller, now);
    case Phase::verify_new:
      return on_verified(job, controller, now);
    case Phase::write_old:
      return on_old_written(job, controller, now);
    case Phase::store_old:
      if (!job.error) return start(Phase::verify_old, controller, now);
      report_.error = *job.error;
      return finish(WriteOutcome::unknown);
    case Phase::verify_old:
      return on_old_verified(job);
    case Phase::idle:
      return;
  }
}

void Transaction::on_read(const Job& job, drivers::Controller& controller, double now) {
  if (job.error) {
    report_.error = *job.error;
    // Nothing was touched: the old values are in force, unless an earlier write-back is unfinished.
    return finish(journal_.unfinished() ? WriteOutcome::unknown
                  : recovering_         ? WriteOutcome::read
                                        : WriteOutcome::rolled_back);
  }
  report_.in_force = job.parameters;
  if (recovering_) return decide_recovery(controller, now);
  report_.before = common(map_of(job.parameters), report_.after);
  report_.after = common(report_.after, report_.before);
  begin_writing(controller, now);
}

void Transaction::begin_writing(drivers::Controller& controller, double now) {
  for (const auto state : {JournalState::begin, JournalState::write})
    if (auto written = announce(state); !written) {
      report_.error = written.error();
      return finish(WriteOutcome::rolled_back);
    }
  if (report_.after.empty()) return finish(WriteOutcome::committed);
  start(Phase::write_new, controller, now);
}

void Transaction::on_written(const Job& job, drivers::Controller& controller, double now) {
  if (job.error) return go_back(*job.error, controller, now);
  if (!holds(job.parameters, report_.after)) return go_back(mismatch("read back"), controller, now);
  report_.in_force = job.parameters;
  if (auto written = announce(JournalState::readback_ok); !written)
    return go_back(written.error(), controller, now);
  if (!stores_any(controller, report_.after)) return finish(WriteOutcome::committed);
  if (auto written = announce(JournalState::store_begin); !written)
    return go_back(written.error(), controller, now);
  store_begun_ = true;
  start(Phase::store_new, controller, now);
}

void Transaction::on_verified(const Job& job, drivers::Controller& controller, double now) {
  if (job.error) return go_back(*job.error, controller, now);
  if (!holds(job.parameters, report_.after)) return go_back(mismatch("after the store"), controller, now);
  report_.in_force = job.parameters;
  // The store is done: a journal that cannot be written now is repaired by the comparison at the next start.
  (void)announce(JournalState::store_ok);
  finish(WriteOutcome::committed);
}

void Transaction::go_back(const Error& why, drivers::Controller& controller, double now) {
  if (!report_.error) report_.error = Error{ErrorCode::write_failed, why.what, why.where, why.remedy};
  (void)announce(JournalState::rollback);
  start(Phase::write_old, controller, now);
}

void Transaction::on_old_written(const Job& job, drivers::Controller& controller, double now) {
  if (job.error || !holds(job.parameters, report_.before)) return finish(WriteOutcome::unknown);
  report_.in_force = job.parameters;
  if (store_begun_) return start(Phase::store_old, controller, now);
  finish(WriteOutcome::rolled_back);
}

void Transaction::on_old_verified(const Job& job) {
  const bool good = !job.error && holds(job.parameters, report_.before);
  if (good) report_.in_force = job.parameters;
  finish(good ? WriteOutcome::rolled_back : WriteOutcome::unknown);
}

// By comparison, not by memory: the journal says only which two sets to compare with.
void Transaction::decide_recovery(drivers::Controller& controller, double now) {
  const auto unfinished = journal_.unfinished();
  if (!unfinished) return finish(WriteOutcome::read);
  report_.label = unfinished->label;
  report_.before = unfinished->before;
  report_.after = unfinished->after;
  store_begun_ = unfinished->state != JournalState::begin && unfinished->state != JournalState::write &&
                 unfinished->state != JournalState::readback_ok;
  if (holds(report_.in_force, report_.after) && unfinished->state != JournalState::rollback) {
    // RAM holds the new set; whether it was stored cannot be seen, storing again is harmless.
    if (auto written = announce(JournalState::store_begin); !written) return finish(WriteOutcome::unknown);
    store_begun_ = true;
    return start(Phase::store_new, controller, now);
  }
  if (holds(report_.in_force, report_.before) && !store_begun_) return finish(WriteOutcome::rolled_back);
  go_back({ErrorCode::write_failed, "an interrupted write-back was undone", "recovery", "apply again"},
          controller, now);
}

void Transaction::finish(WriteOutcome outcome) {
  if (outcome == WriteOutcome::committed) (void)announce(JournalState::commit);
  if (outcome == WriteOutcome::rolled_back && !report_.before.empty())
    (void)announce(JournalState::rolled_back);
  if (outcome == WriteOutcome::unknown) {
    (void)announce(JournalState::needs_operator);
    if (!report_.error) report_.error = mismatch("after restoring");
    report_.error->code = ErrorCode::write_unknown;
  }
  report_.outcome = outcome;
  finished_ = report_;
  phase_ = Phase::idle;
  started_ = false;
}

std::optional<WriteReport> Transaction::take_report() { return std::exchange(finished_, std::nullopt); }

}  // namespace odomcalib
