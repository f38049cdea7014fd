// What clients ask for, one function a method.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/pattern.hpp"
#include "daemon/routines/plans.hpp"
#include "daemon/service/call_parameters.hpp"
#include "daemon/service/json_text.hpp"
#include "daemon/service/service_impl.hpp"

namespace odomcalib {
namespace {

Error out_of_range(const std::string& what) {
  return {ErrorCode::usage, what, "parameters", "see odomcalibctl(1)"};
}

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

constexpr std::size_t kMostRecordings = 8;

// "with": file names of this daemon's own recordings; nothing outside its folder is read for a client.
Result<std::vector<std::filesystem::path>> earlier_recordings(const ordered_json& given,
                                                              const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  if (!given.is_null() && (!given.is_array() || given.size() > kMostRecordings))
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

// Names of effects to fit; without the member those of the daemon.
std::vector<std::string> wanted_effects(CallParameters& options) {
  const ordered_json& given = options.member("effects");
  if (given.is_null()) return PendingCall{}.effects;
  std::vector<std::string> names;
  for (const auto& name : given)
    if (name.is_string()) names.push_back(name.get<std::string>());
  if (!given.is_array() || names.empty() || names.size() != given.size()) options.reject("effects");
  return names;
}

// Values to write by name. None at all is no wish.
ParameterMap wanted_values(CallParameters& parameters) {
  ParameterMap values;
  const ordered_json& given = parameters.member("values");
  if (!given.is_object() || given.empty()) parameters.reject("values");
  if (!given.is_object()) return values;
  CallParameters members(given, "values");
  for (const auto& item : given.items()) values[item.key()] = members.number(item.key().c_str());
  if (members.wrong()) parameters.reject(*members.wrong());
  return values;
}

// The turns of a spin go to the sides that are named.
void choose_sides(CallParameters& parameters, routines::SpinOptions& options) {
  const std::string direction = parameters.text("direction", "both");
  if (direction != "both" && direction != "cw" && direction != "ccw") parameters.reject("direction");
  options.left = direction != "cw";
  options.right = direction != "ccw";
}

}  // namespace

PendingCall pending_of(const IncomingCall& incoming, const ordered_json& parameters) {
  PendingCall pending;
  pending.client = incoming.client;
  pending.method = incoming.call.name();
  pending.more = incoming.call.more;
  pending.lease = CallParameters(parameters).text("lease", "");
  return pending;
}

void Service::Impl::answer(ClientId client, const ordered_json& parameters) {
  server.reply(client, control::encode_reply(json_text(parameters)));
}

void Service::Impl::refuse(ClientId client, const Error& error) {
  server.reply(client, control::encode_error(error));
}

void Service::Impl::refuse_parameter(ClientId client, const std::string& name) {
  server.reply(client, control::encode_invalid_parameter(name));
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
  // Nor would anybody end a recording without a duration. What was recorded is kept.
  if (pending && pending->method == "Record" && pending->client == gone) pending->until = now;
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
  CallParameters given(parameters);
  if (method == "GetStatus") return answer(client, {{"status", status()}});
  if (method == "Describe") return answer(client, {{"description", describe()}});
  if (method == "Check" && !given.flag("nudge")) {
    if (given.wrong()) return refuse_parameter(client, *given.wrong());
    return answer(client, {{"checks", checks()}});
  }
  if (method == "GetParameters") return answer(client, {{"parameters", this->parameters(active)}});
  if (method == "History") return call_history(incoming, parameters);
  if (method == "Monitor") return call_monitor(incoming);
  if (method == "Acquire") {
    const auto granted = lease.acquire(client, now);
    if (!granted) return refuse(client, granted.error());
    return answer(client, {{"lease", granted.value()}, {"ttl_ms", std::lround(1000.0 * safety::kLeaseTime)}});
  }
  if (method == "Renew") {
    const std::string name = given.text("lease", "");
    const double sent = given.number("sent", now);
    if (given.wrong()) return refuse_parameter(client, *given.wrong());
    const auto renewed = lease.renew(name, now, sent);
    if (!renewed) return refuse(client, renewed.error());
    return answer(client, {{"ttl_ms", std::lround(1000.0 * safety::kLeaseTime)}});
  }
  if (method == "Release") {
    lease.release(given.text("lease", ""));
    return answer(client, ordered_json::object());
  }
  if (method == "Stop") return call_stop(incoming);
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

// A stream of events needs a client that takes more than one reply.
void Service::Impl::call_monitor(const IncomingCall& incoming) {
  if (!incoming.call.more) return refuse_parameter(incoming.client, "more");
  monitors.insert(incoming.client);
}

void Service::Impl::call_stop(const IncomingCall& incoming) {
  stop_drive();
  if (run) run->stop({ErrorCode::cancelled, "stopped on request", "motion", "start again"});
  if (solver) *solve_cancelled = true;
  if (pending && pending->method == "Record") pending->until = now;
  event(messages::Severity::stop, "stop", "stopped on request of a client");
  answer(incoming.client, ordered_json::object());
}

void Service::Impl::call_straight(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  routines::StraightOptions options;
  options.distance = given.number("distance");
  options.speed = given.number("speed", options.speed);
  options.repeat = given.whole("repeat", 1);
  options.limits = config.limits;
  (void)given.flag("dry_run");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  if (const auto wrong = wrong_straight(options)) return refuse(incoming.client, *wrong);
  start_motion(incoming, routines::straight_plan(options), parameters, pending_of(incoming, parameters));
}

void Service::Impl::call_spin(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  routines::SpinOptions options;
  options.turns = given.number("turns");
  options.rate = given.number("rate", options.rate);
  options.repeat = given.whole("repeat", 1);
  options.limits = config.limits;
  choose_sides(given, options);
  (void)given.flag("dry_run");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  if (const auto wrong = wrong_spin(options)) return refuse(incoming.client, *wrong);
  start_motion(incoming, routines::spin_plan(options), parameters, pending_of(incoming, parameters));
}

// Straight, spin and pattern as one motion in one recording, or a single manoeuvre that goes with earlier
// recordings.
void Service::Impl::call_calibrate(const IncomingCall& incoming, const ordered_json& parameters) {
  static const ordered_json kNone = ordered_json::object();
  CallParameters given(parameters);
  (void)given.flag("dry_run");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  const ordered_json& wanted = given.member("options");
  CallParameters options(wanted.is_null() ? kNone : wanted, "options");
  PendingCall call = pending_of(incoming, parameters);
  call.effects = wanted_effects(options);
  auto plan = calibration_plan(options);
  if (options.wrong()) return refuse_parameter(incoming.client, *options.wrong());
  if (calibrator.wrong_effects)
    if (const auto wrong = calibrator.wrong_effects(call.effects)) return refuse(incoming.client, *wrong);
  if (!plan) return refuse(incoming.client, plan.error());
  auto earlier = earlier_recordings(options.member("with"), config.state_dir / "recordings");
  if (!earlier) return refuse(incoming.client, earlier.error());
  call.earlier = std::move(earlier).value();
  start_motion(incoming, plan.value(), parameters, std::move(call));
}

Result<routines::Plan> Service::Impl::calibration_plan(CallParameters& options) const {
  const routines::PatternOptions pattern{.area_length = config.area_length,
                                         .area_width = config.area_width,
                                         .track_width = robot().track_width,
                                         .quick = options.flag("quick"),
                                         .limits = config.limits};
  if (const std::string name = options.text("manoeuvre", ""); !name.empty()) {
    auto plan = routines::manoeuvre_plan(name, pattern);
    if (!plan) return out_of_range("there is no manoeuvre \"" + name + "\"");
    return std::move(*plan);
  }
  routines::StraightOptions straight;
  straight.distance = options.number("distance", std::min(1.0, 0.45 * config.area_length));
  straight.speed = options.number("speed", straight.speed);
  straight.repeat = options.whole("repeat", 1);
  routines::SpinOptions spin;
  spin.turns = options.number("turns", 1.0);
  spin.rate = options.number("rate", spin.rate);
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
  CallParameters given(parameters);
  const double duration = given.number("duration", 0.0);
  const std::string name = given.text("name", "record");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  if (!within(duration, 0.0, 3600.0))
    return refuse(incoming.client, out_of_range("duration is not 0 to 3600 s"));
  const auto path = telemetry.recorder.start(name);
  if (!path) return refuse(incoming.client, path.error());
  next_robot = now;
  pending = pending_of(incoming, parameters);
  pending->until = duration > 0.0 ? now + duration : 0.0;
}

void Service::Impl::call_apply(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  const bool dry_run = given.flag("dry_run");
  if (!given.member("calibration").is_object()) given.reject("calibration");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  const auto calibration = calibration_from_json(json_text(given.member("calibration")), "calibration");
  if (!calibration) return refuse(incoming.client, calibration.error());
  if (calibration.value().verdict == Verdict::refused)
    return refuse(incoming.client, {ErrorCode::refused, "this calibration was refused by its quality gate",
                                    "calibration", "record again and solve"});
  if (const auto member = non_finite_value(calibration.value()))
    return refuse(incoming.client, {ErrorCode::format, "\"" + *member + "\" has no finite value",
                                    "calibration", "solve the recording again"});
  ParameterMap values;
  for (const auto* name : {"left_wheel_diameter", "right_wheel_diameter", "track_width"})
    if (const auto value = calibration.value().parameter(name)) values[name] = *value;
  call.calibration = to_json(calibration.value());
  start_write(incoming, values, std::move(call), dry_run);
}

void Service::Impl::call_set(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  const bool dry_run = given.flag("dry_run");
  const ParameterMap values = wanted_values(given);
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  start_write(incoming, values, std::move(call), dry_run);
}

void Service::Impl::call_rollback(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  const bool dry_run = given.flag("dry_run");
  const std::string id = given.text("id", "");
  if (given.wrong()) return refuse_parameter(incoming.client, *given.wrong());
  PendingCall call = pending_of(incoming, parameters);
  if (const auto forbidden = write_forbidden(call.lease)) return refuse(incoming.client, *forbidden);
  const auto former = former_values(id);
  if (!former)
    return refuse(
        incoming.client,
        {ErrorCode::usage, id.empty() ? "no write-back was committed" : "no history entry \"" + id + "\"", "",
         "odomcalibctl history"});
  call.calibration = former->calibration;
  start_write(incoming, former->values, std::move(call), dry_run);
}

void Service::Impl::call_history(const IncomingCall& incoming, const ordered_json& parameters) {
  CallParameters given(parameters);
  const int limit = given.whole("limit", std::numeric_limits<int>::max());
  if (given.wrong() || limit < 0) return refuse_parameter(incoming.client, "limit");
  ordered_json list = ordered_json::array();
  for (const auto& entry : history.entries())
    if (list.size() < static_cast<std::size_t>(limit))
      list.push_back(ordered_json::parse(to_json(entry, false)));
  answer(incoming.client, {{"entries", list}});
}

}  // namespace odomcalib
