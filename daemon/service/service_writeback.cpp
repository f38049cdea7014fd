// Write-back: what must be true before it, and what came of it.
#include <fmt/format.h>

#include <cmath>

#include "daemon/service/service_impl.hpp"

namespace odomcalib {
namespace {

std::string outcome_name(WriteOutcome outcome) {
  if (outcome == WriteOutcome::committed) return "committed";
  return outcome == WriteOutcome::rolled_back ? "rolled_back" : "unknown";
}

ordered_json to_json(const RoundingError& error) {
  return {{"length", error.length}, {"heading", error.heading}, {"turn", error.turn}};
}

}  // namespace

std::optional<Error> Service::Impl::write_forbidden(const std::string& name) const {
  if (!lease.holds(name))
    return Error{ErrorCode::not_permitted, "no lease", "write-back", "acquire one and keep it alive"};
  if (transaction.busy())
    return Error{ErrorCode::refused, "another write-back is running", "", "wait for its end"};
  if (base.controller().state() != drivers::ControllerState::disabled)
    return Error{ErrorCode::device, "controller is " + name_of(base.controller().state()), "write-back",
                 "values are written only to a controller that answers and whose axes are off"};
  if (!parameters_known)
    return Error{ErrorCode::device, "the controller's values were not read yet", "write-back",
                 "wait, or check the bus"};
  return std::nullopt;
}

void Service::Impl::start_write(const IncomingCall& incoming, const ParameterMap& values, PendingCall call,
                                bool dry_run) {
  const RobotDescription all = robot();
  const ParameterMap old{{"left_wheel_diameter", all.left_wheel_diameter},
                         {"right_wheel_diameter", all.right_wheel_diameter},
                         {"track_width", all.track_width}};
  for (const auto& [name, value] : values) {
    const auto known = old.find(name);
    if (known == old.end())
      return refuse(incoming.client,
                    {ErrorCode::usage, "unknown parameter \"" + name + "\"", "", "odomcalibctl params get"});
    const bool plausible = std::isfinite(value) && std::abs(value / known->second - 1.0) <= kPlausible;
    if (!plausible)
      return refuse(incoming.client,
                    {ErrorCode::refused,
                     fmt::format("{} = {} m is more than 15 % from {} m", name, value, known->second),
                     "write-back", "check the nominal values"});
  }
  const RoundedParameters rounded = round_together(values, in_force);
  call.rounding = rounded.remaining;
  if (dry_run) {
    std::optional<Calibration> wanted;
    if (call.calibration)
      if (auto read = calibration_from_json(*call.calibration, "calibration"))
        wanted = std::move(read).value();
    return answer(incoming.client, {{"result",
                                     {{"outcome", "dry_run"},
                                      {"before", old},
                                      {"after", rounded.values},
                                      {"rounding_error", to_json(call.rounding)},
                                      {"parameters", parameters(wanted)}}}});
  }
  const std::string label = call.method == "Rollback" ? "rollback" : "apply";
  const std::string journaled = journal.last() ? journal.last()->calibration : "";
  const auto calibration = call.method == "SetParameters"
                               ? Result<std::string>(std::string())
                               : in_force_file.announce(call.calibration, journaled);
  if (!calibration) return refuse(incoming.client, calibration.error());
  if (auto begun = transaction.write(label, rounded.values, calibration.value()); !begun)
    return refuse(incoming.client, begun.error());
  pending = std::move(call);
}

void Service::Impl::serve_writeback() {
  const auto state = base.controller().state();
  // What is there when it comes back, and what it holds, is to be seen, at once: nothing moves before.
  if (state == drivers::ControllerState::absent && !transaction.busy()) {
    parameters_known = recovery_tried = false;
    if (!ending) next_read = now;
  }
  if (state == drivers::ControllerState::disabled && !transaction.busy() && !run && now >= next_read)
    begin_reading();
  transaction.step(base.controller(), now, clock.wall_us());
  if (const auto report = transaction.take_report()) write_ended(*report);
}

// One recovery a connection: each may store once, and permanent memory wears out. After it only reads are
// repeated. It waits for rest (B6 step 2), reading alone does not.
void Service::Impl::begin_reading() {
  const bool recover = operator_needed && !recovery_tried;
  if (recover ? !base.controller().at_rest() : parameters_known) return;
  next_read = now + 2.0;
  (void)(recover ? transaction.recover() : transaction.read());
}

void Service::Impl::write_ended(const WriteReport& report) {
  learn(report);
  if (report.outcome == WriteOutcome::read) return;
  const bool committed = report.outcome == WriteOutcome::committed;
  if (!report.steps.empty()) note_in_history(report);
  event(committed ? messages::Severity::info : messages::Severity::fault, "write_back",
        outcome_name(report.outcome) + (report.error ? ": " + report.error->text() : ""));
  const auto unsettled = settle_calibration(committed ? report.calibration : "");
  if (!pending) return;
  if (!committed)
    return fail_pending(report.error.value_or(Error{ErrorCode::write_failed, "write-back failed", "", ""}));
  if (unsettled) return fail_pending(*unsettled);
  finish_pending({{"outcome", outcome_name(report.outcome)},
                  {"steps", report.steps},
                  {"before", report.before},
                  {"after", report.after},
                  {"rounding_error", to_json(pending->rounding)},
                  {"parameters", parameters(active)}});
}

void Service::Impl::learn(const WriteReport& report) {
  const bool unknown = report.outcome == WriteOutcome::unknown;
  const bool was_read = !report.in_force.empty() || !report.error;
  if (was_read) in_force = report.in_force;
  parameters_known = !unknown && (parameters_known || was_read);
  recovery_tried = recovery_tried || unknown;
  operator_needed = unknown || (report.outcome == WriteOutcome::read && journal.unfinished());
  if (operator_needed && report.error) write_problem = report.error->text();
  next_robot = now;
}

// A recovery that fails in the same way at every start tells nothing new, and must not push out what could be
// rolled back to.
void Service::Impl::note_in_history(const WriteReport& report) {
  HistoryEntry entry;
  entry.time = clock.wall_us();
  entry.action = report.label;
  entry.outcome = outcome_name(report.outcome);
  entry.before = report.before;
  entry.after = report.after;
  entry.device = report.device;
  if (report.outcome == WriteOutcome::committed)
    entry.calibration = in_force_file.announced(report.calibration);
  const auto all = history.entries();
  const bool known = !all.empty() && report.outcome == WriteOutcome::unknown &&
                     all.front().outcome == entry.outcome && all.front().action == entry.action &&
                     all.front().before == entry.before && all.front().after == entry.after;
  if (known) return;
  if (const auto added = history.add(entry); !added)
    event(messages::Severity::warning, "history", added.error().text());
}

/// @return why the host goes on with the former calibration although the controller has the values of this
/// one
std::optional<Error> Service::Impl::settle_calibration(const std::string& id) {
  const auto settled = in_force_file.settle(id);
  load_active();
  if (settled) return std::nullopt;
  event(messages::Severity::fault, "active", settled.error().text());
  return Error{
      settled.error().code,
      "the values are in the controller, but corrected odometry goes on with the former calibration (" +
          settled.error().what + ")",
      settled.error().where, settled.error().remedy + "; then apply again"};
}

// Without an id: what an unfinished write-back is to be taken back to, else what the newest committed one
// replaced. One that was rolled back or ended unknown has put nothing in force that could be taken back.
std::optional<FormerValues> Service::Impl::former_values(const std::string& id) const {
  const auto unfinished = journal.unfinished();
  if (id.empty() && unfinished && !unfinished->before.empty())
    return FormerValues{unfinished->before,
                        active ? std::optional(odomcalib::to_json(*active)) : std::nullopt};
  const auto entry = id.empty() ? history.newest_committed() : history.find(id);
  if (!entry) return std::nullopt;
  FormerValues former{entry->before, std::nullopt};
  // The calibration in force before that entry is the one of the newest older entry that was committed.
  for (const auto& older : history.entries())
    if (older.id < entry->id && older.outcome == "committed" && !former.calibration)
      former.calibration = older.calibration;
  return former;
}

void Service::Impl::load_active() {
  active.reset();
  corrected.reset();
  const auto& path = in_force_file.path();
  if (!std::filesystem::exists(path)) return;
  auto calibration = read_calibration(path);
  if (!calibration) return event(messages::Severity::warning, "active", calibration.error().text());
  active = std::move(calibration).value();
  if (calibrator.odometry) corrected = calibrator.odometry(*active);
}

}  // namespace odomcalib
