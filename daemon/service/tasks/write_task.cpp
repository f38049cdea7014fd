#include "daemon/service/tasks/write_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/write_gate.hpp"

namespace odomcalib {

ordered_json to_json(const RoundingError& error) {
  return {{"length", error.length}, {"heading", error.heading}, {"turn", error.turn}};
}

Result<std::unique_ptr<Task>> WriteTask::begin(const Parts& parts, const Caller& caller, const Order& order,
                                               double now) {
  if (parts.write_back.busy())
    return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  // Its entry would get the number of one that is there and cannot be seen.
  if (const auto& why = parts.write_back.history.unlisted()) return *why;
  std::unique_ptr<WriteTask> task(new WriteTask(parts, caller, order, now));
  task->announce();
  return std::unique_ptr<Task>(std::move(task));
}

namespace {

/// A disk that did not take the entries of earlier write-backs has to take them first: it would forget what
/// the journal alone still knows.
Result<std::string> announced_id(const ParameterTask::Parts& parts,
                                 const std::optional<std::string>& calibration, bool replaces,
                                 const std::vector<HistoryEntry>& unwritten, const std::string& journaled) {
  for (const HistoryEntry& entry : unwritten)
    if (auto written = parts.write_back.history.write(entry); !written) return written.error();
  return replaces ? parts.applied.file.announce(calibration, journaled) : Result<std::string>("");
}

}  // namespace

// The task may be gone when the disk is done.
void WriteTask::announce() {
  announced_->unwritten = parts_.write_back.unwritten;
  announced_->done = !order_.replaces_calibration && announced_->unwritten.empty();
  if (announced_->done) return;
  parts_.disk.post(
      [parts = parts_, text = order_.calibration, replaces = order_.replaces_calibration,
       journaled = parts_.write_back.journaled_calibration(), announced = announced_] {
        announced->id = announced_id(parts, text, replaces, announced->unwritten, journaled);
      },
      [parts = parts_, announced = announced_] {
        announced->done = true;
        if (announced->id) parts.write_back.unwritten.clear();
      });
}

TaskTurn WriteTask::begin_writing(double now) {
  if (parts_.write_back.ending())
    return Failed{{ErrorCode::cancelled, "the daemon ends", "write-back", "start again"}};
  if (!announced_->done || parts_.write_back.busy()) return Running{};
  if (!announced_->id) return Failed{announced_->id.error()};
  if (auto forbidden = write_forbidden(parts_.drive, parts_.write_back)) return Failed{*forbidden};
  if (comes_to_rest(parts_.drive))
    return now - asked_at_ < service::settings::kComesToRest_s ? TaskTurn(Running{})
                                                               : Failed{axes_not_off(parts_.drive)};
  const auto prover = order_.prove ? std::optional(caller.client) : std::nullopt;
  const auto begun = parts_.write_back.write(order_.label, order_.rounded.values, announced_->id.value(),
                                             prover, order_.origin);
  if (!begun) return Failed{begun.error()};
  parts_.write_back.rounding = order_.rounded.remaining;
  parts_.write_back.place = order_.place;
  parts_.outbox.event(messages::Severity::info, "write_back",
                      order_.label + (order_.place.empty() ? "" : " to " + order_.place) + " begins, for " +
                          parts_.outbox.server.name_of(caller.client));
  begun_ = true;
  return Running{};
}

TaskTurn WriteTask::turn(double now) {
  if (!begun_) return begin_writing(now);
  const auto end = parts_.write_back.take_end();
  return end ? turn_of(parts_, *end) : TaskTurn(Running{});
}

ordered_json write_reply(const ParameterTask::Parts& parts, const WriteReport& report,
                         const ParameterMap& before, const ParameterMap& after,
                         const RoundingError& remaining) {
  // Old values that a client asked back are what it wanted.
  const bool asked = report.outcome == WriteOutcome::rolled_back;
  ordered_json result = {
      {"outcome", name_of(asked ? WriteOutcome::committed : report.outcome)},
      {"steps", report.steps},
      {"before", before},
      {"after", after},
      {"rounding_error", to_json(remaining)},
      {"parameters", parameter_report(parts.drive, parts.calibrator, parts.applied.get())}};
  if (!parts.write_back.place.empty()) result["goes_to"] = parts.write_back.place;
  return {{"result", std::move(result)}};
}

TaskTurn turn_of(const ParameterTask::Parts& parts, const WriteEnd& end) {
  const WriteReport& report = end.report;
  if (!ending_of(report.outcome).as_asked)
    return Failed{report.error.value_or(Error{ErrorCode::write_failed, "write-back failed", "", ""})};
  if (end.unsettled) return Failed{*end.unsettled};
  return done_with(write_reply(parts, report, report.before, report.after, parts.write_back.rounding));
}

TaskTurn ProofTask::store(double now) {
  if (const auto lacking = parts_.write_back.proof.lacking()) return Failed{*lacking};
  if (comes_to_rest(parts_.drive) && now - asked_at_ < service::settings::kComesToRest_s) return Running{};
  if (parts_.drive.controller().state() != drivers::ControllerState::disabled)
    return Failed{axes_not_off(parts_.drive)};
  if (auto stored = parts_.write_back.store(); !stored) return Failed{stored.error()};
  begun_ = true;
  return Running{};
}

TaskTurn ProofTask::turn(double now) {
  if (!begun_ && proven_) return store(now);
  // Unproven values go back once the axes are off, whether somebody waits for it or not.
  if (!begun_) {
    parts_.write_back.take_back("whoever drove the proof takes the values back");
    parts_.write_back.place = kBeforeProof;
  }
  begun_ = true;
  const bool waits = parts_.write_back.transaction.proving();
  if (waits && now - asked_at_ > service::settings::kComesToRest_s) return Failed{axes_not_off(parts_.drive)};
  const auto end = parts_.write_back.take_end();
  if (!end) return Running{};
  const WriteReport& report = end->report;
  if (!proven_ && report.outcome == WriteOutcome::rolled_back)
    return done_with(write_reply(parts_, report, report.after, report.before, {}));
  return turn_of(parts_, *end);
}

}  // namespace odomcalib
