#include "daemon/service/write_outcome.hpp"

namespace odomcalib {
namespace {

void learn(Bench& bench, const WriteReport& report) {
  const bool unknown = report.outcome == WriteOutcome::unknown;
  const bool was_read = !report.in_force.empty() || !report.error;
  if (was_read) bench.drive.in_force = report.in_force;
  bench.drive.values_known = !unknown && (bench.drive.values_known || was_read);
  bench.write_back.learn(report);
  bench.outbox.send_robot_soon();
}

// A recovery that fails in the same way at every start tells nothing new, and must not push out what could be
// rolled back to.
void note_in_history(Bench& bench, const WriteReport& report) {
  HistoryEntry entry;
  entry.time = bench.clock.wall_us();
  entry.action = report.label;
  entry.outcome = name_of(report.outcome);
  entry.before = report.before;
  entry.after = report.after;
  entry.device = report.device;
  if (report.outcome == WriteOutcome::committed)
    entry.calibration = bench.applied.file.announced(report.calibration);
  History& history = bench.write_back.history;
  const auto& all = history.entries();
  const bool known = !all.empty() && report.outcome == WriteOutcome::unknown &&
                     all.front().outcome == entry.outcome && all.front().action == entry.action &&
                     all.front().before == entry.before && all.front().after == entry.after;
  if (known) return;
  entry = history.numbered(std::move(entry));
  if (const auto written = history.write(entry); !written)
    return bench.outbox.event(messages::Severity::warning, "history", written.error().text());
  history.keep(std::move(entry));
}

}  // namespace

void settle_write(Bench& bench, const WriteReport& report) {
  learn(bench, report);
  if (report.outcome == WriteOutcome::read) return;
  const bool committed = report.outcome == WriteOutcome::committed;
  if (!report.steps.empty()) note_in_history(bench, report);
  bench.outbox.event(committed ? messages::Severity::info : messages::Severity::fault, "write_back",
                     name_of(report.outcome) + (report.error ? ": " + report.error->text() : ""));
  auto unsettled = settle_calibration(bench, committed ? report.calibration : "");
  bench.write_back.ended = WriteEnd{report, std::move(unsettled)};
}

std::optional<Error> settle_calibration(Bench& bench, const std::string& id) {
  const auto settled = bench.applied.file.settle(id);
  if (const auto problem = bench.applied.load())
    bench.outbox.event(messages::Severity::warning, "active", problem->text());
  if (settled) return std::nullopt;
  bench.outbox.event(messages::Severity::fault, "active", settled.error().text());
  return Error{
      settled.error().code,
      "the values are in the controller, but corrected odometry goes on with the former calibration (" +
          settled.error().what + ")",
      settled.error().where, settled.error().remedy + "; then apply again"};
}

}  // namespace odomcalib
