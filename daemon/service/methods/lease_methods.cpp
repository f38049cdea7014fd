// Who may move the robot, and the stop, which everybody may ask for.
#include <algorithm>
#include <cmath>

#include "daemon/service/call_parameters.hpp"
#include "daemon/service/methods/methods.hpp"

namespace odomcalib {
namespace {

const auto kTtlMilliseconds = std::lround(1000.0 * safety::kLeaseTime);

}  // namespace

Reading acquire(Context& context, const Call& call) {
  const auto granted = context.parts.lease.acquire(call.caller.client, context.parts.now);
  if (!granted) return granted.error();
  return Answer{{{"lease", granted.value()}, {"ttl_ms", kTtlMilliseconds}}};
}

Reading renew(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  const double now = context.parts.now;
  const std::string lease = given.text("lease", "");
  const double sent = given.number("sent", call.arrived);
  if (given.wrong()) return WrongParameter{*given.wrong()};
  // One that has waited behind other calls says that the client was there when it arrived.
  const auto renewed = context.parts.lease.renew(lease, now, std::min(sent, call.arrived));
  if (!renewed) return renewed.error();
  return Answer{{{"ttl_ms", kTtlMilliseconds}}};
}

Reading release(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  const std::string lease = given.text("lease", "");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  const auto released = context.parts.lease.release(lease);
  if (!released) return released.error();
  return Answer{ordered_json::object()};
}

void stop_robot(Context context) {
  RobotParts& parts = context.parts;
  stop_drive(parts.drive, parts.write_back, parts.now);
  if (context.task != nullptr) context.task->stop(parts.now);
  parts.outbox.event(messages::Severity::stop, "stop", "stopped on request of a client");
}

// One that was found on its arrival has been obeyed then: what has begun since was asked for after it.
Reading stop(Context& context, const Call& call) {
  if (!call.stopped_since) stop_robot(context);
  return Answer{ordered_json::object()};
}

}  // namespace odomcalib
