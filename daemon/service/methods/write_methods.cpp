// Values into the controller, and back.
#include "daemon/service/call_parameters.hpp"
#include "daemon/service/methods/methods.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/tasks/reading_task.hpp"
#include "daemon/service/tasks/write_task.hpp"
#include "daemon/service/write_gate.hpp"
#include "daemon/writeback/calibration_in_force.hpp"
#include "proto/base_quantities.hpp"
#include "proto/file_bytes.hpp"

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

// Written values are rounded to what the controller can hold.
struct Wish {
  ParameterMap values;
  std::string label = "apply";
  std::optional<std::string> calibration;  ///< JSON text
  bool replaces_calibration = true;
  bool prove = false;
  std::string place = {};     ///< where a rollback goes, in words
  std::string verified = {};  ///< see FormerValues: the band does not hold for what was in force before
  Provenance origin = {};
  std::vector<std::string> asks = {};  ///< what the caller has to vouch for, and has not yet
};

ordered_json dry_run_report(const RobotParts& parts, const ParameterMap& present,
                            const RoundedParameters& rounded, const Wish& wish) {
  std::optional<Calibration> wanted;
  if (wish.calibration)
    if (auto read = calibration_from_json(*wish.calibration, "calibration")) wanted = std::move(read).value();
  ordered_json report = {
      {"outcome", "dry_run"},
      {"before", present},
      {"after", rounded.values},
      {"rounding_error", to_json(rounded.remaining)},
      {"parameters", parameter_report(parts.drive, parts.calibrator, wanted, rounded.values)},
      {"asks", wish.asks}};
  if (!wish.place.empty()) report["goes_to"] = wish.place;
  return report;
}

/// Report on values that wait for their proof, and on what was in force before them.
ordered_json discard_report(const RobotParts& parts) {
  const auto& last = parts.write_back.transaction.journal().last();
  Wish wish;
  wish.place = kBeforeProof;
  return dry_run_report(parts, present_lengths(parts.drive.robot()),
                        {last ? last->before : ParameterMap(), {}}, wish);
}

Error not_vouched_for(const std::string& what) {
  return {
      ErrorCode::refused, what, "calibration",
      "state robot.id in the configuration, or say that it is: odomcalibctl apply asks (\"of_this_robot\")"};
}

ParameterTask::Parts for_writing(RobotParts& parts) {
  return {parts.write_back, parts.drive, parts.applied, parts.calibrator, parts.outbox, *parts.disk};
}

Outcome begin_write(RobotParts& parts, const Caller& caller, Wish wish, bool dry_run) {
  const ParameterMap present = present_lengths(parts.drive.robot());
  const NominalLengths nominal = nominal_lengths(parts.drive, parts.config);
  if (const auto wrong = implausible(wish.values, nominal)) {
    if (wish.verified.empty()) return *wrong;
    wish.place += "; " + wrong->what;  // what was verified may come back all the same, and it is said
  }
  const RoundedParameters rounded = round_together(wish.values, parts.drive.in_force);
  if (dry_run) return Answer{{{"result", dry_run_report(parts, present, rounded, wish)}}};
  if (!wish.asks.empty()) return not_vouched_for(wish.asks.front());
  Provenance origin = wish.origin;
  origin.user = parts.outbox.server.user_of(caller.client);
  origin.robot_id = parts.drive.nominal().robot_id;
  origin.nominal = nominal.values;
  origin.nominal_from = nominal.from;
  const WriteTask::Order order{wish.label, rounded,    wish.calibration, wish.replaces_calibration,
                               wish.prove, wish.place, std::move(origin)};
  return begin_reading(parts, caller, [&parts, caller, order]() -> Result<std::unique_ptr<Task>> {
    if (auto changed = parts.drive.changed_besides(order.rounded.values)) return *changed;
    return WriteTask::begin(for_writing(parts), caller, order, parts.now);
  });
}

/// Where the configuration names this robot, a calibration names the same one.
std::optional<Error> of_another_robot(const Calibration& calibration, const std::string& ours) {
  const std::string& theirs = calibration.robot.robot_id;
  if (ours.empty() || theirs == ours) return std::nullopt;
  const std::string whose = theirs.empty() ? "a robot without a name" : "\"" + theirs + "\"";
  return Error{ErrorCode::refused, "this calibration is of " + whose + ", this robot is \"" + ours + "\"",
               "calibration", "solve a recording of this robot; its file or robot file names robot_id"};
}

/// A calibration shows the wheels as one controller counts them. One that does not say which is believed.
std::optional<Error> of_another_controller(const Calibration& calibration, const std::string& ours,
                                           bool replaced) {
  const std::string& theirs = calibration.robot.controller_id;
  if (theirs.empty() || ours.empty() || theirs == ours || replaced) return std::nullopt;
  return Error{
      ErrorCode::refused,
      "this calibration was made with the controller \"" + theirs + "\", this one is \"" + ours + "\"",
      "calibration",
      "calibrate again; where one of the same kind took its place: odomcalibctl apply --replaced"};
}

/// Without a name in the configuration nobody can know whether the calibration is this robot's.
std::string whose_robot(const Calibration& calibration) {
  const std::string& theirs = calibration.robot.robot_id;
  return "robot.id is not configured, so that this robot cannot be told from others: the calibration is of " +
         (theirs.empty() ? "a robot without a name" : "\"" + theirs + "\"");
}

/// The values of a calibration that a controller may hold.
Result<Wish> wish_of(Calibration calibration, const RobotParts& parts, bool replaced) {
  const std::string& robot = parts.drive.nominal().robot_id;
  if (calibration.verdict == Verdict::refused)
    return Error{ErrorCode::refused, "this calibration was refused by its quality gate", "calibration",
                 "record again and solve"};
  if (auto wrong = of_another_robot(calibration, robot)) return *wrong;
  if (auto wrong = of_another_controller(calibration, device_of(parts.drive.controller()), replaced))
    return *wrong;
  if (auto wrong =
          absurd(calibration, nominal_lengths(parts.drive, parts.config), parts.calibrator.unit_of_effect))
    return *wrong;
  Wish wish;
  if (robot.empty()) wish.asks.push_back(whose_robot(calibration));
  for (const BaseQuantity length : kDriveLengths)
    if (const auto value = calibration.parameter(length)) wish.values[name_of(length)] = *value;
  wish.calibration = text_in_force(std::move(calibration));
  wish.origin.calibration_sha256 = sha256_hex(*wish.calibration);
  return wish;
}

/// @param wish from the call to what is to be written, once a write-back is allowed at all
template <typename MakeWish>
Reading write_request(Context& context, const Call& call, MakeWish make_wish) {
  CallParameters given(call.parameters);
  const std::string lease = given.text("lease", "");
  const bool dry_run = given.flag("dry_run");
  return Request{lease, dry_run,
                 [&parts = context.parts, caller = call.caller, dry_run, make_wish]() -> Outcome {
                   if (auto forbidden = write_forbidden(parts.drive, parts.write_back)) return *forbidden;
                   const Result<Wish> wish = make_wish();
                   if (!wish) return wish.error();
                   return begin_write(parts, caller, wish.value(), dry_run);
                 }};
}

}  // namespace

Reading apply(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  (void)given.flag("dry_run");
  const bool prove = given.flag("prove"), replaced = given.flag("replaced"),
             ours = given.flag("of_this_robot");
  const ordered_json& wanted = given.member("calibration");
  if (!wanted.is_object()) given.reject("calibration");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  return write_request(context, call,
                       [&parts = context.parts, &wanted, prove, replaced, ours]() -> Result<Wish> {
                         auto calibration = calibration_from(wanted, "calibration");
                         if (!calibration) return calibration.error();
                         auto wish = wish_of(std::move(calibration).value(), parts, replaced);
                         if (wish) wish.value().prove = prove;
                         if (wish && ours) wish.value().asks.clear();
                         return wish;
                       });
}

namespace {

Reading end_proof(Context& context, const Call& call, bool proven) {
  return Request{CallParameters(call.parameters).text("lease", ""), false,
                 [&parts = context.parts, caller = call.caller, proven]() -> Outcome {
                   const WriteBack& values = parts.write_back;
                   // Values that have gone back by themselves are discarded, too.
                   if (proven ? !values.proving() : !values.busy() && !values.proving() && !values.ended)
                     return Error{ErrorCode::refused, "no values wait for their proof", "write-back",
                                  "odomcalibctl params get"};
                   const auto task = [&parts, caller, proven]() -> std::unique_ptr<Task> {
                     return std::make_unique<ProofTask>(for_writing(parts), caller, proven, parts.now);
                   };
                   if (!proven) return task();
                   return begin_reading(parts, caller, [&parts, task]() -> Result<std::unique_ptr<Task>> {
                     if (auto changed = parts.drive.changed_besides({})) return *changed;
                     return task();
                   });
                 }};
}

}  // namespace

// Stores values that were written with "prove", and have been proven.
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
  const WayWanted wanted{given.text("id", ""), given.text("to", ""), given.flag("replaced")};
  if (!wanted.before.empty() && !wanted.after.empty()) given.reject("to");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  const bool named = !wanted.before.empty() || !wanted.after.empty();
  if (context.parts.write_back.proving() && !named)
    return given.flag("dry_run") ? Reading(Outcome(Answer{{{"result", discard_report(context.parts)}}}))
                                 : end_proof(context, call, false);
  return write_request(context, call, [&parts = context.parts, wanted]() -> Result<Wish> {
    const auto former = parts.write_back.former_values(wanted, device_of(parts.drive.controller()),
                                                       parts.drive.in_force, parts.applied.text());
    if (!former) return former.error();
    const FormerValues& back = former.value();
    Wish wish{back.values, "rollback", back.calibration};
    wish.place = back.place;
    wish.verified = back.verified;
    wish.origin.restores = back.restores;
    wish.origin.proven = back.proven;
    return wish;
  });
}

}  // namespace odomcalib
