// Values into the controller, and back.
#include "daemon/service/call_parameters.hpp"
#include "daemon/service/methods/methods.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/tasks/proof_task.hpp"
#include "daemon/service/tasks/reading_task.hpp"
#include "daemon/service/tasks/write_task.hpp"
#include "daemon/service/write_gate.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib {
namespace {

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

// What is written is rounded to what the controller can hold.
struct Wish {
  ParameterMap values;
  std::string label = "apply";
  std::optional<std::string> calibration;  ///< JSON text
  bool replaces_calibration = true;
  bool prove = false;
};

ordered_json dry_run_report(const Bench& bench, const ParameterMap& present, const RoundedParameters& rounded,
                            const Wish& wish) {
  std::optional<Calibration> wanted;
  if (wish.calibration)
    if (auto read = calibration_from_json(*wish.calibration, "calibration")) wanted = std::move(read).value();
  return {{"outcome", "dry_run"},
          {"before", present},
          {"after", rounded.values},
          {"rounding_error", to_json(rounded.remaining)},
          {"parameters", parameter_report(bench, wanted)}};
}

Outcome begin_write(Bench& bench, const Caller& caller, const Wish& wish, bool dry_run) {
  const ParameterMap present = present_lengths(bench.drive.robot());
  if (auto wrong = implausible(wish.values, present)) return *wrong;
  const RoundedParameters rounded = round_together(wish.values, bench.drive.in_force);
  if (dry_run) return Answer{{{"result", dry_run_report(bench, present, rounded, wish)}}};
  const WriteTask::Order order{wish.label, rounded, wish.calibration, wish.replaces_calibration, wish.prove};
  ReadingTask::Next next = [caller, order](Bench& read) -> Result<std::unique_ptr<Task>> {
    if (auto changed = read.drive.changed_besides(order.rounded.values)) return *changed;
    return WriteTask::begin(read, caller, order);
  };
  return std::make_unique<ReadingTask>(caller, bench.now, std::move(next));
}

/// Where the configuration names this robot, a calibration names the same one.
std::optional<Error> of_another_robot(const Calibration& calibration, const std::string& ours) {
  const std::string& theirs = calibration.robot.robot_id;
  if (ours.empty() || theirs == ours) return std::nullopt;
  const std::string whose = theirs.empty() ? "a robot without a name" : "\"" + theirs + "\"";
  return Error{ErrorCode::refused, "this calibration is of " + whose + ", this robot is \"" + ours + "\"",
               "calibration", "solve a recording of this robot; its file or robot file names robot_id"};
}

/// Former values belong to the controller that held them. One that does not say who it is is believed.
std::optional<Error> of_another_controller(const std::string& theirs, const std::string& ours) {
  if (theirs.empty() || ours.empty() || theirs == ours) return std::nullopt;
  return Error{ErrorCode::refused,
               "these values are of the controller \"" + theirs + "\", this one is \"" + ours + "\"",
               "rollback", "connect that controller, or apply a calibration to this one"};
}

/// The values of a calibration that a controller may hold.
Result<Wish> wish_of(Calibration calibration, const std::string& robot) {
  if (calibration.verdict == Verdict::refused)
    return Error{ErrorCode::refused, "this calibration was refused by its quality gate", "calibration",
                 "record again and solve"};
  if (auto wrong = of_another_robot(calibration, robot)) return *wrong;
  if (const auto member = non_finite_value(calibration))
    return Error{ErrorCode::format, "\"" + *member + "\" has no finite value", "calibration",
                 "solve the recording again"};
  Wish wish;
  for (const auto* name : {"left_wheel_diameter", "right_wheel_diameter", "track_width"})
    if (const auto value = calibration.parameter(name)) wish.values[name] = *value;
  // What is in force is kept, journaled and read again and again.
  calibration.extensions.erase(kPictureMember);
  wish.calibration = to_json(calibration);
  return wish;
}

/// @param wish from the call to what is to be written, once a write-back is allowed at all
template <typename MakeWish>
Reading write_request(Context& context, const Call& call, MakeWish make_wish) {
  CallParameters given(call.parameters);
  const std::string lease = given.text("lease", "");
  const bool dry_run = given.flag("dry_run");
  return Request{lease, dry_run,
                 [&bench = context.bench, caller = call.caller, dry_run, make_wish]() -> Outcome {
                   if (auto forbidden = write_forbidden(bench)) return *forbidden;
                   const Result<Wish> wish = make_wish();
                   if (!wish) return wish.error();
                   return begin_write(bench, caller, wish.value(), dry_run);
                 }};
}

}  // namespace

Reading apply(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  (void)given.flag("dry_run");
  const bool prove = given.flag("prove");
  const ordered_json& wanted = given.member("calibration");
  if (!wanted.is_object()) given.reject("calibration");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  return write_request(context, call, [&bench = context.bench, &wanted, prove]() -> Result<Wish> {
    auto calibration = calibration_from(wanted, "calibration");
    if (!calibration) return calibration.error();
    auto wish = wish_of(std::move(calibration).value(), bench.drive.robot().robot_id);
    if (wish) wish.value().prove = prove;
    return wish;
  });
}

namespace {

Reading end_proof(Context& context, const Call& call, bool proven) {
  return Request{CallParameters(call.parameters).text("lease", ""), false,
                 [&bench = context.bench, caller = call.caller, proven]() -> Outcome {
                   const WriteBack& values = bench.write_back;
                   // What has gone back by itself is discarded, too.
                   if (proven ? !values.proving() : !values.busy() && !values.proving() && !values.ended)
                     return Error{ErrorCode::refused, "no values wait for their proof", "write-back",
                                  "odomcalibctl params get"};
                   if (!proven) return std::make_unique<ProofTask>(caller, proven, bench.now);
                   return std::make_unique<ReadingTask>(
                       caller, bench.now, [caller](Bench& read) -> Result<std::unique_ptr<Task>> {
                         if (auto changed = read.drive.changed_besides({})) return *changed;
                         return std::unique_ptr<Task>(std::make_unique<ProofTask>(caller, true, read.now));
                       });
                 }};
}

}  // namespace

// What was written with "prove", and has been proven.
Reading store(Context& context, const Call& call) { return end_proof(context, call, true); }

Reading discard(Context& context, const Call& call) { return end_proof(context, call, false); }

Reading set_parameters(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  (void)given.flag("dry_run");
  const ParameterMap values = wanted_values(given);
  if (given.wrong()) return WrongParameter{*given.wrong()};
  return write_request(context, call, [values]() -> Result<Wish> {
    Wish wish;
    wish.values = values;
    wish.replaces_calibration = false;
    return wish;
  });
}

Reading rollback(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  (void)given.flag("dry_run");
  const std::string id = given.text("id", "");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  if (context.bench.write_back.proving() && id.empty() && !given.flag("dry_run"))
    return end_proof(context, call, false);
  return write_request(context, call, [&bench = context.bench, id]() -> Result<Wish> {
    const auto former = bench.write_back.former_values(id, bench.applied.text());
    if (!former)
      return Error{ErrorCode::usage,
                   id.empty() ? "no write-back was committed" : "no history entry \"" + id + "\"", "",
                   "odomcalibctl history"};
    if (auto wrong = of_another_controller(former->device, device_of(bench.drive.controller())))
      return *wrong;
    return Wish{former->values, "rollback", former->calibration};
  });
}

}  // namespace odomcalib
