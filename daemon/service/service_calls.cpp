// What clients ask for, one function a method.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/pattern.hpp"
#include "daemon/routines/plans.hpp"
#include "daemon/service/json_text.hpp"
#include "daemon/service/service_impl.hpp"

namespace odomcalib {
namespace {

double number(const ordered_json& parameters, const char* name, double otherwise) {
  const auto found = parameters.find(name);
  if (found == parameters.end() || found->is_null()) return otherwise;
  return found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string text(const ordered_json& parameters, const char* name, const std::string& otherwise) {
  const auto found = parameters.find(name);
  return found != parameters.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

bool flag(const ordered_json& parameters, const char* name) {
  const auto found = parameters.find(name);
  return found != parameters.end() && found->is_boolean() && found->get<bool>();
}

Error out_of_range(const std::string& what) {
  return {ErrorCode::usage, what, "parameters", "see odomcalibctl(1)"};
}

// NaN (no number at all) fails every comparison and is out of range.
bool within(double value, double least, double most) { return value >= least && value <= most; }

std::optional<Error> wrong_straight(const routines::StraightOptions& options) {
  if (!within(std::abs(options.distance), 0.05, 5.0))
    return out_of_range("distance is not between 0.05 and 5 m");
  if (!within(options.speed, 0.02, 10.0)) return out_of_range("speed is not between 0.02 and 10 m/s");
  if (options.repeat < 1 || options.repeat > 20) return out_of_range("repeat is not between 1 and 20");
  return std::nullopt;
}

std::optional<Error> wrong_spin(const routines::SpinOptions& options) {
  if (!within(options.turns, 0.05, 10.0)) return out_of_range("turns is not between 0.05 and 10");
  if (!within(options.rate, 0.05, 10.0)) return out_of_range("rate is not between 0.05 and 10 rad/s");
  if (options.repeat < 1 || options.repeat > 20) return out_of_range("repeat is not between 1 and 20");
  return std::nullopt;
}

int whole(double value) { return within(value, 0.0, 1000.0) ? static_cast<int>(std::lround(value)) : 0; }

constexpr std::size_t kMostRecordings = 8;

// "with": file names of this daemon's own recordings; nothing outside its folder is read for a client.
Result<std::vector<std::filesystem::path>> earlier_recordings(const ordered_json& options,
                                                              const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  const auto given = options.value("with", ordered_json::array());
  if (!given.is_array() || given.size() > kMostRecordings)
    return out_of_range("\"with\" is no list of recordings");
  for (const auto& name : given) {
    const auto file = std::filesystem::path(name.is_string() ? name.get<std::string>() : "").filename();
    std::error_code error;
    if (file.empty() || !std::filesystem::is_regular_file(folder / file, error))
      return out_of_range("no recording \"" + file.string() + "\"");
    paths.push_back(folder / file);
  }
  return paths;
}

}  // namespace

PendingCall pending_of(const IncomingCall& incoming, const ordered_json& parameters) {
  PendingCall pending;
  pending.client = incoming.client;
  pending.method = incoming.call.name();
  pending.more = incoming.call.more;
  pending.lease = text(parameters, "lease", "");
  return pending;
}

void Service::Impl::answer(ClientId client, const ordered_json& parameters) {
  server.reply(client, control::encode_reply(json_text(parameters)));
}

void Service::Impl::refuse(ClientId client, const Error& error) {
  server.reply(client, control::encode_error(error));
}

void Service::Impl::finish_pending(const ordered_json& result) {
  if (pending) answer(pending->client, {{"result", result}});
  pending.reset();
}

void Service::Impl::fail_pending(const Error& error) {
  event(messages::Severity::warning, "failed", error.text());
  if (pending) refuse(pending->client, error);
  pending.reset();
}

void Service::Impl::serve_clients() {
  // The last wait saw every client: where nothing woke it, nothing had arrived.
  if (!due(clients_woke, next_clients)) return lease.looked(now);
  server.step();
  for (const ClientId gone : server.take_gone()) forget(gone);
  for (const IncomingCall& incoming : server.take_calls()) handle(incoming);
  lease.looked(now);
}

void Service::Impl::forget(ClientId gone) {
  lease.lost(gone);
  monitors.erase(gone);
  // Who asked for a motion and went away cannot watch it: it ends.
  if (run && pending && pending->client == gone)
    run->stop({ErrorCode::cancelled, "the client closed its connection", "motion", "start again"});
}

void Service::Impl::handle(const IncomingCall& incoming) {
  const auto parameters = ordered_json::parse(incoming.call.parameters, nullptr, false);
  if (!parameters.is_object()) return refuse(incoming.client, out_of_range("parameters are no object"));
  dispatch(incoming, parameters);
}

void Service::Impl::dispatch(const IncomingCall& incoming, const ordered_json& parameters) {
  const std::string method = incoming.call.name();
  const ClientId client = incoming.client;
  if (ending && method != "GetStatus" && method != "Stop")
    return refuse(client, {ErrorCode::refused, "the daemon is ending", "odomcalibd",
                           "start it again: systemctl start odomcalib"});
  if (method == "GetStatus") return answer(client, {{"status", status()}});
  if (method == "Describe") return answer(client, {{"description", describe()}});
  if (method == "Check" && !flag(parameters, "nudge")) return answer(client, {{"checks", checks()}});
  if (method == "GetParameters") return answer(client, {{"parameters", this->parameters(active)}});
  if (method == "History") return call_history(incoming, parameters);
  if (method == "Monitor") {
    monitors.insert(client);
    return;
  }
  if (method == "Acquire") {
    const auto given = lease.acquire(client, now);
    if (!given) return refuse(client, given.error());
    return answer(client, {{"lease", given.value()}, {"ttl_ms", std::lround(1000.0 * safety::kLeaseTime)}});
  }
  if (method == "Renew") {
    const auto renewed = lease.renew(text(parameters, "lease", ""), now, number(parameters, "sent", now));
    if (!renewed) return refuse(client, renewed.error());
    return answer(client, {{"ttl_ms", std::lround(1000.0 * safety::kLeaseTime)}});
  }
  if (method == "Release") {
    lease.release(text(parameters, "lease", ""));
    return answer(client, ordered_json::object());
  }
  if (method == "Stop") {
    stop_drive();
    if (run) run->stop({ErrorCode::cancelled, "stopped on request", "motion", "start again"});
    if (pending && pending->method == "Record") pending->until = now;
    event(messages::Severity::stop, "stop", "stopped on request of a client");
    return answer(client, ordered_json::object());
  }
  if (pending)
    return refuse(client, {ErrorCode::refused, "busy: " + activity(), "", "wait for its end, or stop it"});
  if (method == "Check") return call_check(incoming, parameters);
  if (method == "Straight") return call_straight(incoming, parameters);
  if (method == "Spin") return call_spin(incoming, parameters);
  if (method == "Calibrate") return call_calibrate(incoming, parameters);
  if (method == "Record") return call_record(incoming, parameters);
  if (method == "Apply") return call_apply(incoming, parameters);
  if (method == "SetParameters") return call_set(incoming, parameters);
  if (method == "Rollback") return call_rollback(incoming, parameters);
  server.reply(client, control::encode_method_not_implemented(incoming.call.method));
}

void Service::Impl::call_straight(const IncomingCall& incoming, const ordered_json& parameters) {
  routines::StraightOptions options;
  options.distance = number(parameters, "distance", options.distance);
  options.speed = number(parameters, "speed", options.speed);
  options.repeat = whole(number(parameters, "repeat", 1));
  options.limits = config.limits;
  if (const auto wrong = wrong_straight(options)) return refuse(incoming.client, *wrong);
  start_motion(incoming, routines::straight_plan(options), parameters, pending_of(incoming, parameters));
}

void Service::Impl::call_spin(const IncomingCall& incoming, const ordered_json& parameters) {
  routines::SpinOptions options;
  options.turns = number(parameters, "turns", options.turns);
  options.rate = number(parameters, "rate", options.rate);
  options.repeat = whole(number(parameters, "repeat", 1));
  options.limits = config.limits;
  const std::string direction = text(parameters, "direction", "both");
  options.left = direction != "cw";
  options.right = direction != "ccw";
  if (const auto wrong = wrong_spin(options)) return refuse(incoming.client, *wrong);
  start_motion(incoming, routines::spin_plan(options), parameters, pending_of(incoming, parameters));
}

// Straight, spin and pattern as one motion in one recording, or a single manoeuvre that goes with earlier
// recordings.
void Service::Impl::call_calibrate(const IncomingCall& incoming, const ordered_json& parameters) {
  const auto options = parameters.value("options", ordered_json::object());
  if (!options.is_object()) return refuse(incoming.client, out_of_range("options are no object"));
  auto plan = calibration_plan(options);
  if (!plan) return refuse(incoming.client, plan.error());
  auto earlier = earlier_recordings(options, config.state_dir / "recordings");
  if (!earlier) return refuse(incoming.client, earlier.error());
  PendingCall call = pending_of(incoming, parameters);
  call.earlier = std::move(earlier).value();
  if (const auto effects = options.find("effects"); effects != options.end() && effects->is_array()) {
    call.effects.clear();
    for (const auto& effect : *effects)
      if (effect.is_string()) call.effects.push_back(effect.get<std::string>());
  }
  start_motion(incoming, plan.value(), parameters, std::move(call));
}

Result<routines::Plan> Service::Impl::calibration_plan(const ordered_json& options) const {
  const routines::PatternOptions pattern{.area_length = config.area_length,
                                         .area_width = config.area_width,
                                         .track_width = robot().track_width,
                                         .quick = flag(options, "quick"),
                                         .limits = config.limits};
  if (const std::string name = text(options, "manoeuvre", ""); !name.empty()) {
    auto plan = routines::manoeuvre_plan(name, pattern);
    if (!plan) return out_of_range("there is no manoeuvre \"" + name + "\"");
    return std::move(*plan);
  }
  routines::StraightOptions straight;
  straight.distance = number(options, "distance", std::min(1.0, 0.45 * config.area_length));
  straight.speed = number(options, "speed", straight.speed);
  straight.repeat = whole(number(options, "repeat", 1));
  routines::SpinOptions spin;
  spin.turns = number(options, "turns", 1.0);
  spin.rate = number(options, "rate", spin.rate);
  spin.repeat = straight.repeat;
  if (const auto wrong = wrong_straight(straight)) return *wrong;
  if (const auto wrong = wrong_spin(spin)) return *wrong;
  routines::Plan plan = routines::straight_plan(straight);
  for (const auto& part : {routines::spin_plan(spin), routines::pattern_plan(pattern)})
    plan.moves.insert(plan.moves.end(), part.moves.begin(), part.moves.end());
  plan.name = "calibrate";
  plan.limits = config.limits;
  return plan;
}

void Service::Impl::call_record(const IncomingCall& incoming, const ordered_json& parameters) {
  const double duration = number(parameters, "duration", 0.0);
  if (!within(duration, 0.0, 3600.0))
    return refuse(incoming.client, out_of_range("duration is not 0 to 3600 s"));
  const auto path = telemetry.recorder.start(text(parameters, "name", "record"));
  if (!path) return refuse(incoming.client, path.error());
  next_robot = now;
  pending = pending_of(incoming, parameters);
  pending->until = duration > 0.0 ? now + duration : 0.0;
}

void Service::Impl::call_apply(const IncomingCall& incoming, const ordered_json& parameters) {
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  const auto calibration = calibration_from_json(
      json_text(parameters.value("calibration", ordered_json::object())), "calibration");
  if (!calibration) return refuse(incoming.client, calibration.error());
  if (calibration.value().verdict == Verdict::refused)
    return refuse(incoming.client, {ErrorCode::refused, "this calibration was refused by its quality gate",
                                    "calibration", "record again and solve"});
  ParameterMap values;
  for (const auto* name : {"left_wheel_diameter", "right_wheel_diameter", "track_width"})
    if (const auto value = calibration.value().parameter(name)) values[name] = *value;
  call.calibration = to_json(calibration.value());
  start_write(incoming, values, std::move(call), flag(parameters, "dry_run"));
}

void Service::Impl::call_set(const IncomingCall& incoming, const ordered_json& parameters) {
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  ParameterMap values;
  const auto wanted = parameters.value("values", ordered_json::object());
  for (const auto& [name, value] : wanted.items())
    values[name] = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  start_write(incoming, values, std::move(call), flag(parameters, "dry_run"));
}

void Service::Impl::call_rollback(const IncomingCall& incoming, const ordered_json& parameters) {
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  const std::string id = text(parameters, "id", "");
  const auto former = former_values(id);
  if (!former)
    return refuse(
        incoming.client,
        {ErrorCode::usage, id.empty() ? "no write-back was committed" : "no history entry \"" + id + "\"", "",
         "odomcalibctl history"});
  call.calibration = former->calibration;
  start_write(incoming, former->values, std::move(call), flag(parameters, "dry_run"));
}

void Service::Impl::call_history(const IncomingCall& incoming, const ordered_json& parameters) {
  const double limit = number(parameters, "limit", 1e6);
  ordered_json list = ordered_json::array();
  for (const auto& entry : history.entries())
    if (static_cast<double>(list.size()) < limit) list.push_back(ordered_json::parse(to_json(entry, false)));
  answer(incoming.client, {{"entries", list}});
}

}  // namespace odomcalib
