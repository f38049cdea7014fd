#include "daemon/cli/proven_apply.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/output.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

/// A failed write has left the old values, as far as the daemon could see to it and say so.
bool is_final(const Error& failed) {
  return failed.code != ErrorCode::write_unknown && failed.code != ErrorCode::not_running &&
         failed.code != ErrorCode::io;
}

Error unseen_drive() {
  return {ErrorCode::refused, "the lidar did not recognise the place after every move", "comparison",
          "drive where it sees walls on all sides, not along a corridor"};
}

std::string name_of(ProvenApply::End end) {
  constexpr std::array kNames = {"stored", "not_stored", "taken_back", "in_doubt"};
  return kNames.at(static_cast<std::size_t>(end));
}

Error not_better(const std::string& what) {
  return {ErrorCode::write_failed, what + "; the old values are in force again", "proof run",
          "look for slip and for what has changed between the two drives, then calibrate again"};
}

/// A motion that ended early proves nothing, and has its own exit status.
Error not_proven(Error why) {
  why.what = "not proven, the old values are in force again: " + why.what;
  return why;
}

/// The daemon goes on trying; what it has not stored does not outlive the controller's power either.
Error not_taken_back(const Error& why, const Error& failed) {
  return {
      ErrorCode::write_unknown,
      "nothing was stored, but nobody has seen the old values return (" + failed.text() + "): " + why.what,
      "proof run", "see odomcalibctl params get once the controller answers"};
}

ProvenApply not_applied(ProvenApply applied, const Error& why) {
  applied.error = why;
  if (!is_final(why)) applied.end = ProvenApply::End::in_doubt;
  return applied;
}

ProvenApply take_back(const RunMethod& always, ProvenApply applied, const Error& why) {
  applied.error = why;
  applied.end = ProvenApply::End::taken_back;
  const auto back = always("Discard", ordered_json::object());
  if (back) return applied;
  applied.error = not_taken_back(why, back.error());
  applied.end = ProvenApply::End::in_doubt;
  return applied;
}

/// A store that has begun and failed has ended with the old values, or says that it has not.
ProvenApply store(const RunMethod& run, const RunMethod& always, ProvenApply applied) {
  const auto stored = run("Store", ordered_json::object());
  applied.end = stored ? ProvenApply::End::stored : ProvenApply::End::taken_back;
  if (stored) return applied;
  const bool begun = stored.error().code == ErrorCode::write_failed || !is_final(stored.error());
  return begun ? not_applied(std::move(applied), stored.error())
               : take_back(always, std::move(applied), not_proven(stored.error()));
}

}  // namespace

Result<DriveErrors> drive_errors(const RunMethod& run) {
  DrivenErrors seen;
  for (const auto& [method, parameters] :
       {std::pair<const char*, ordered_json>{"Straight", {{"distance", 1.0}}},
        std::pair<const char*, ordered_json>{"Spin", {{"turns", 1.0}}}}) {
    const auto driven = run(method, parameters);
    if (!driven) return driven.error();
    if (!seen.add(driven.value())) return unseen_drive();
  }
  const auto errors = seen.all();
  return errors ? Result<DriveErrors>(*errors) : unseen_drive();
}

std::optional<Error> needs_a_person(const Calibration& calibration) {
  if (calibration.verdict == Verdict::accepted) return std::nullopt;
  const std::string why = calibration.reasons.empty()
                              ? "no reason is stated"
                              : fmt::format("{}", fmt::join(calibration.reasons, "; "));
  if (calibration.verdict == Verdict::refused)
    return Error{ErrorCode::refused, "refused: " + why, "calibration", "record again"};
  return Error{ErrorCode::refused,
               "nothing was written, because somebody has to judge a warning first: " + why, "calibration",
               "read the report; odomcalibctl apply writes it all the same"};
}

std::optional<Error> unprovable(const ordered_json& parameters) {
  for (const auto& one : parameters)
    if (one.is_object() && one.value("unit", "") == "m" && one.value("stored_in", "") != "controller")
      return Error{ErrorCode::refused,
                   "the controller does not hold " + one.value("name", "") +
                       ", so that its odometry after a write-back proves nothing",
                   "calibrate --apply", "odomcalibctl calibrate --out FILE, then odomcalibctl apply FILE"};
  return std::nullopt;
}

ProvenApply apply_and_prove(const RunMethod& run, const RunMethod& always, const Calibration& calibration,
                            const DriveErrors& before) {
  ProvenApply applied;
  applied.before = before;
  if ((applied.error = needs_a_person(calibration))) return applied;
  auto wanted = ordered_json::parse(to_json(calibration), nullptr, false);
  wanted.erase(kPictureMember);
  if (const auto written = run("Apply", {{"calibration", wanted}, {"prove", true}}); !written)
    return not_applied(std::move(applied), written.error());
  const auto after = drive_errors(run);
  if (after) applied.after = after.value();
  const auto what = after ? worse(before, after.value()) : std::nullopt;
  if (after && !what) return store(run, always, std::move(applied));
  return take_back(always, std::move(applied), after ? not_better(*what) : not_proven(after.error()));
}

ProofEntry entry_of(const ProvenApply& applied) {
  ProofEntry entry{name_of(applied.end), applied.before, applied.after, std::nullopt};
  if (const auto& error = applied.error)
    entry.error = {code_name(error->code), error->what, error->where, error->remedy};
  return entry;
}

Document describe(const ProvenApply& applied) {
  constexpr std::array kHeadlines = {"stored, and proven by a fresh motion", "not stored",
                                     "taken back, the old values are in force",
                                     "IN DOUBT: not proven, and what is in force was not seen"};
  return {kHeadlines.at(static_cast<std::size_t>(applied.end)),
          {{"", {}, trial_table({applied.before, applied.after})}}};
}

}  // namespace odomcalib::cli
