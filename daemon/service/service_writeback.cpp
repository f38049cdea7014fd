// Write-back: what must be true before it, and what came of it.
#include <fmt/format.h>

#include <cmath>

#include "daemon/service/service_impl.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

// More than this from the values in force is no calibration but another robot.
constexpr double kPlausible = 0.15;

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
  if (auto begun = transaction.write(label, rounded.values); !begun)
    return refuse(incoming.client, begun.error());
  pending = std::move(call);
}

void Service::Impl::serve_writeback() {
  const bool ready = base.controller().state() == drivers::ControllerState::disabled;
  if (!parameters_known && ready && !transaction.busy() && now >= next_read) {
    next_read = now + 2.0;
    (void)transaction.recover();
  }
  // A controller that has gone keeps the transaction waiting for its time-out, not for ever.
  transaction.step(base.controller(), now, clock.wall_us());
  if (const auto report = transaction.take_report()) write_ended(*report);
}

void Service::Impl::write_ended(const WriteReport& report) {
  if (!report.in_force.empty() || !report.error) in_force = report.in_force;
  operator_needed = report.outcome == WriteOutcome::unknown;
  if (!report.error || report.outcome == WriteOutcome::committed) parameters_known = true;
  next_robot = now;
  if (report.outcome == WriteOutcome::read) return;
  HistoryEntry entry;
  entry.time = clock.wall_us();
  entry.action = report.label;
  entry.outcome = outcome_name(report.outcome);
  entry.before = report.before;
  entry.after = report.after;
  const bool committed = report.outcome == WriteOutcome::committed;
  if (pending && committed) entry.calibration = pending->calibration;
  if (const auto added = history.add(entry); !added)
    event(messages::Severity::warning, "history", added.error().text());
  event(committed ? messages::Severity::info : messages::Severity::fault, "write_back", entry.outcome);
  if (!pending) return;
  if (!committed)
    return fail_pending(report.error.value_or(Error{ErrorCode::write_failed, "write-back failed", "", ""}));
  if (pending->method != "SetParameters") set_active(pending->calibration);
  finish_pending({{"outcome", entry.outcome},
                  {"steps", report.steps},
                  {"before", report.before},
                  {"after", report.after},
                  {"rounding_error", to_json(pending->rounding)},
                  {"parameters", parameters(active)}});
}

void Service::Impl::set_active(const std::optional<std::string>& calibration_json) {
  const auto path = config.state_dir / "active.json";
  std::error_code ignored;
  if (!calibration_json)
    std::filesystem::remove(path, ignored);
  else if (const auto written = replace_file(path, *calibration_json); !written)
    event(messages::Severity::warning, "active", written.error().text());
  load_active();
}

void Service::Impl::load_active() {
  active.reset();
  corrected.reset();
  const auto path = config.state_dir / "active.json";
  if (!std::filesystem::exists(path)) return;
  auto calibration = read_calibration(path);
  if (!calibration) return event(messages::Severity::warning, "active", calibration.error().text());
  active = std::move(calibration).value();
  if (calibrator.odometry) corrected = calibrator.odometry(*active);
}

}  // namespace odomcalib
