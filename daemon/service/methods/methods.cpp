#include "daemon/service/methods/methods.hpp"

#include <algorithm>
#include <array>
#include <regex>

#include "daemon/service/call_parameters.hpp"
#include "daemon/service/status_report.hpp"
#include "proto/control/control.hpp"

namespace odomcalib {
namespace {

using When = Method::When;
using Lease = Method::Lease;

// Who may call at all is checked when a client connects (ControlServer). Order: the first row that fits.
constexpr std::array kMethods = {
    Method{"GetStatus", When::always, Lease::none, "", get_status},
    Method{"Stop", When::always, Lease::none, "", stop},
    Method{"GetScan", When::unless_ending, Lease::none, "", get_scan},
    Method{"Describe", When::unless_ending, Lease::none, "", describe},
    Method{"GetParameters", When::unless_ending, Lease::none, "", get_parameters},
    Method{"History", When::unless_ending, Lease::none, "", get_history},
    Method{"Monitor", When::unless_ending, Lease::none, "", monitor},
    Method{"Acquire", When::unless_ending, Lease::none, "", acquire},
    Method{"Renew", When::unless_ending, Lease::none, "", renew},
    Method{"Release", When::unless_ending, Lease::none, "", release},
    Method{"Check", When::when_idle, Lease::unless_dry_run, "motion", nudge, "nudge"},
    Method{"Check", When::unless_ending, Lease::none, "", check},
    Method{"Straight", When::when_idle, Lease::unless_dry_run, "motion", square, "square"},
    Method{"Straight", When::when_idle, Lease::unless_dry_run, "motion", straight},
    Method{"Spin", When::when_idle, Lease::unless_dry_run, "motion", spin},
    Method{"Calibrate", When::when_idle, Lease::unless_dry_run, "motion", calibrate},
    Method{"Record", When::when_idle, Lease::none, "", record},
    Method{"Apply", When::when_idle, Lease::unless_dry_run, "write-back", apply},
    Method{"Store", When::when_idle, Lease::always, "write-back", store},
    Method{"Discard", When::when_idle, Lease::always, "write-back", discard},
    Method{"SetParameters", When::when_idle, Lease::unless_dry_run, "write-back", set_parameters},
    Method{"Rollback", When::when_idle, Lease::unless_dry_run, "write-back", rollback},
};

// Method of the interface, but of no service of this version.
constexpr Method kUnknown{"", When::when_idle};

const Method& method_of(const std::string& name, const ordered_json& parameters) {
  const auto found = std::find_if(kMethods.begin(), kMethods.end(), [&](const Method& method) {
    return name == method.name && (method.flag == nullptr || CallParameters(parameters).flag(method.flag));
  });
  return found == kMethods.end() ? kUnknown : *found;
}

/// Names of a method's parameters, read from the description of the interface; empty: it has none.
std::vector<std::string> parameters_of(const std::string& method) {
  const std::string_view interface = control::interface_description();
  const std::string head = "\nmethod " + method + "(";
  const std::size_t begin = interface.find(head);
  if (begin == std::string_view::npos) return {};
  const std::string parameters(
      interface.substr(begin + head.size(), interface.find(')', begin) - begin - head.size()));
  static const std::regex kName(R"((\w+)\s*:)");
  std::vector<std::string> names;
  for (std::sregex_iterator it(parameters.begin(), parameters.end(), kName), end; it != end; ++it)
    names.push_back((*it)[1].str());
  return names;
}

std::optional<Error> not_now(const Method& method, const Context& context, bool stopped_since) {
  if (context.parts.ending && method.when != When::always)
    return Error{ErrorCode::refused, "the daemon is ending", "odomcalibd",
                 "start it again: systemctl start odomcalib"};
  if (context.task != nullptr && method.when == When::when_idle)
    return Error{ErrorCode::busy, "busy: " + activity(context.parts, context.task), "",
                 "wait for its end, or stop it"};
  if (stopped_since && method.when == When::when_idle)
    return Error{ErrorCode::cancelled, "stopped on request before it began", method.name, "start again"};
  return std::nullopt;
}

Outcome begin(const Method& method, const Context& context, const Request& request) {
  const bool required =
      method.lease == Lease::always || (method.lease == Lease::unless_dry_run && !request.dry_run);
  if (required && !context.parts.lease.holds(request.lease))
    return Error{ErrorCode::not_permitted, "no lease", method.lease_of, "acquire one and keep it alive"};
  return request.begin();
}

Outcome outcome_of(const Method& method, Context& context, const Call& call) {
  if (method.when == When::when_idle) {  // it moves the robot, or writes
    auto known = parameters_of(method.name);
    known.emplace_back("lease");  // does no harm where none is needed
    CallParameters given(call.parameters);
    given.only(known);
    if (given.wrong()) return WrongParameter{*given.wrong()};
  }
  Reading read = method.handle(context, call);
  if (auto* outcome = std::get_if<Outcome>(&read)) return std::move(*outcome);
  return begin(method, context, std::get<Request>(read));
}

std::unique_ptr<Task> settle_outcome(Outcome outcome, const Caller& caller, Outbox& outbox) {
  if (const auto* answer = std::get_if<Answer>(&outcome)) outbox.answer(caller, answer->parameters);
  if (const auto* error = std::get_if<Error>(&outcome)) outbox.refuse(caller, *error);
  if (const auto* wrong = std::get_if<WrongParameter>(&outcome)) outbox.refuse_parameter(caller, wrong->name);
  auto* task = std::get_if<std::unique_ptr<Task>>(&outcome);
  return task != nullptr ? std::move(*task) : nullptr;
}

}  // namespace

std::unique_ptr<Task> begin_reading(RobotParts& parts, const Caller& caller, ReadingTask::Next next) {
  return std::make_unique<ReadingTask>(ReadingTask::Parts{parts.write_back, parts.drive, parts.outbox},
                                       caller, parts.now, std::move(next));
}

std::unique_ptr<Task> handle_call(Context context, const IncomingCall& incoming) {
  Outbox& outbox = context.parts.outbox;
  const Caller caller{incoming.client, incoming.call.more, incoming.call.oneway};
  const Method& method = method_of(incoming.call.name(), incoming.call.parameters);
  if (auto refused = not_now(method, context, incoming.stopped_since))
    return settle_outcome(*refused, caller, outbox);
  if (method.handle == nullptr) {
    outbox.refuse_method(caller, incoming.call.method);
    return nullptr;
  }
  const Call call{caller, incoming.call.parameters, incoming.arrived, incoming.stopped_since};
  return settle_outcome(outcome_of(method, context, call), caller, outbox);
}

}  // namespace odomcalib
