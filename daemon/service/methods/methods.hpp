// The methods of the control interface, each with its handler and what it requires.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "daemon/service/parts/robot_parts.hpp"
#include "daemon/service/tasks/reading_task.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

/// Objects that a method works on.
struct Context {
  RobotParts& parts;
  Task* task = nullptr;  ///< that runs, or null
};

struct Call {
  Caller caller;
  const ordered_json& parameters;  ///< an object
  double arrived = 0.0;            ///< s
  bool stopped_since = false;      ///< see IncomingCall
};

struct Answer {
  ordered_json parameters;
};
/// A member of the call is missing or of a wrong type.
struct WrongParameter {
  std::string name;
};
/// Replies follow by themselves.
struct Subscribed {};
/// Outcome of a call. A task answers its caller when it ends.
using Outcome = std::variant<Answer, Error, WrongParameter, Subscribed, std::unique_ptr<Task>>;

/// A call that is right in itself. It begins when its caller holds the lease that the method requires.
struct Request {
  std::string lease;
  bool dry_run = false;
  std::function<Outcome()> begin;
};
using Reading = std::variant<Outcome, Request>;

using Handler = Reading(Context& context, const Call& call);

struct Method {
  enum class When { always, unless_ending, when_idle };
  enum class Lease { none, unless_dry_run, always };

  const char* name;
  When when = When::unless_ending;
  Lease lease = Lease::none;
  const char* lease_of = "";  ///< what the lease is for, in the error
  Handler* handle = nullptr;
  const char* flag = nullptr;  ///< this row is about calls in which the flag is set
};

/// Answers the call or begins what it asks for. @return the task that it began, or null
std::unique_ptr<Task> handle_call(Context context, const IncomingCall& incoming);

/// Obeys a stop at once; the call is answered in its place.
void stop_robot(Context context);

/// Reads the controller again before what follows, which `next` makes or refuses.
std::unique_ptr<Task> begin_reading(RobotParts& parts, const Caller& caller, ReadingTask::Next next);

// status_methods.cpp
Handler get_status, get_scan, describe, check, get_parameters, get_history, monitor;
// lease_methods.cpp
Handler acquire, renew, release, stop;
// motion_methods.cpp
Handler nudge, straight, square, spin, calibrate, record;
// write_methods.cpp
Handler apply, store, discard, set_parameters, rollback;

}  // namespace odomcalib
