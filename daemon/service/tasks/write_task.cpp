#include "daemon/service/tasks/write_task.hpp"

#include "daemon/service/settings.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/write_gate.hpp"

namespace odomcalib {
ordered_json to_json(const RoundingError& error) {
  return {{"length", error.length}, {"heading", error.heading}, {"turn", error.turn}};
}

Result<std::unique_ptr<Task>> WriteTask::begin(Bench& bench, const Caller& caller, const Order& order) {
  if (bench.write_back.busy())
    return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  std::unique_ptr<WriteTask> task(new WriteTask(caller, order, bench.now));
  task->announce(bench);
  return std::unique_ptr<Task>(std::move(task));
}

// The task may be gone when the disk is done.
void WriteTask::announce(Bench& bench) {
  announced_->done = !order_.replaces_calibration;
  if (announced_->done) return;
  bench.disk->post([&file = bench.applied.file, text = order_.calibration,
                    journaled = bench.write_back.journaled_calibration(),
                    announced = announced_] { announced->id = file.announce(text, journaled); },
                   [announced = announced_] { announced->done = true; });
}

TaskTurn WriteTask::begin_writing(Bench& bench) {
  if (bench.ending) return Failed{{ErrorCode::cancelled, "the daemon ends", "write-back", "start again"}};
  if (!announced_->done || bench.write_back.busy()) return Running{};
  if (!announced_->id) return Failed{announced_->id.error()};
  if (auto forbidden = write_forbidden(bench)) return Failed{*forbidden};
  if (comes_to_rest(bench))
    return bench.now - asked_at_ < service::settings::kComesToRest_s ? TaskTurn(Running{})
                                                                     : Failed{axes_not_off(bench)};
  const auto prover = order_.prove ? std::optional(caller.client) : std::nullopt;
  const auto begun =
      bench.write_back.write(order_.label, order_.rounded.values, announced_->id.value(), prover);
  if (!begun) return Failed{begun.error()};
  bench.write_back.rounding = order_.rounded.remaining;
  bench.outbox.event(messages::Severity::info, "write_back",
                     order_.label + " begins, for " + bench.outbox.server.name_of(caller.client));
  begun_ = true;
  return Running{};
}

TaskTurn WriteTask::turn(Bench& bench) {
  if (!begun_) return begin_writing(bench);
  const auto end = bench.write_back.take_end();
  return end ? turn_of(bench, *end) : TaskTurn(Running{});
}

ordered_json write_reply(const Bench& bench, const WriteReport& report, const ParameterMap& before,
                         const ParameterMap& after, const RoundingError& remaining) {
  // Old values that a client asked back are what it wanted.
  const bool asked = report.outcome == WriteOutcome::rolled_back;
  return {{"result",
           {{"outcome", name_of(asked ? WriteOutcome::committed : report.outcome)},
            {"steps", report.steps},
            {"before", before},
            {"after", after},
            {"rounding_error", to_json(remaining)},
            {"parameters", parameter_report(bench, bench.applied.get())}}}};
}

TaskTurn turn_of(const Bench& bench, const WriteEnd& end) {
  const WriteReport& report = end.report;
  if (report.outcome != WriteOutcome::committed && report.outcome != WriteOutcome::proving)
    return Failed{report.error.value_or(Error{ErrorCode::write_failed, "write-back failed", "", ""})};
  if (end.unsettled) return Failed{*end.unsettled};
  return done_with(write_reply(bench, report, report.before, report.after, bench.write_back.rounding));
}

}  // namespace odomcalib
