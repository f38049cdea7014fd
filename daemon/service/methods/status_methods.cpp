// The robot's state, the values in force, and the history.
#include <limits>

#include "daemon/service/call_parameters.hpp"
#include "daemon/service/methods/methods.hpp"
#include "daemon/service/status_report.hpp"

namespace odomcalib {

Reading get_status(Context& context, const Call& /*call*/) {
  return Answer{{{"status", status_report(context.parts, context.task)}}};
}

Reading get_scan(Context& context, const Call& /*call*/) {
  return Answer{{{"scan", scan_report(context.parts.surroundings, context.parts.now)}}};
}

Reading describe(Context& context, const Call& /*call*/) {
  return Answer{{{"description", description(context.parts.config)}}};
}

Reading check(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  (void)given.flag("nudge");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  return Answer{{{"checks", check_report(context.parts)}}};
}

Reading get_parameters(Context& context, const Call& /*call*/) {
  const RobotParts& parts = context.parts;
  return Answer{{{"parameters", parameter_report(parts.drive, parts.calibrator, parts.applied.get())}}};
}

Reading get_history(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  const int limit = given.whole("limit", std::numeric_limits<int>::max());
  if (given.wrong() || limit < 0) return WrongParameter{"limit"};
  const History& history = context.parts.write_back.history;
  // A part of the list, or an empty one, would say that nothing else was ever written.
  if (history.unlisted()) return *history.unlisted();
  ordered_json list = ordered_json::array();
  for (const auto& entry : history.entries())
    if (list.size() < static_cast<std::size_t>(limit))
      list.push_back(ordered_json::parse(to_json(entry, false)));
  return Answer{
      {{"entries", list}, {"calibrations", (context.parts.config.state_dir / "calibrations").string()}}};
}

// A stream of events needs a client that takes more than one reply.
Reading monitor(Context& context, const Call& call) {
  if (!call.caller.more) return WrongParameter{"more"};
  context.parts.outbox.monitor(call.caller.client);
  return Subscribed{};
}

}  // namespace odomcalib
