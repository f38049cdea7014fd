// Verbs that move the robot or write to its controller: consent, lease, progress, result.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "daemon/cli/answer_documents.hpp"
#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/motion_call.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/proven_apply.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/file_bytes.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

struct MotionOptions {
  Consent consent;
  std::string file, id;
  std::string to;
  bool quick = false, one_drive = false, nudge = false, apply = false, replaced = false;
  std::vector<std::string> assignments;
};

/// @param document that the result is
int print_result(const Session& session, const std::string& document, const Result<ordered_json>& result) {
  if (!result) return report_error(result.error(), session.json);
  const ordered_json& body = result.value();
  if (session.json != JsonMode::off) {
    print_document(document, body, session.json);
  } else if (document == "plan") {
    print_text(describe_plan(body), session.legend);
  } else if (body.contains("steps") || body.contains("parameters")) {
    print_text(describe_write_back(body), session.legend);
  } else {
    std::cout << body.dump(2) << '\n';
  }
  return kDone;
}

struct Solved {
  Calibration calibration;
  ordered_json body;  ///< result of the daemon
};

// Drives, records and solves.
Result<Solved> drive_and_solve(const Session& session, const MotionOptions& options,
                               const ordered_json& wanted) {
  const auto result = run_method(session, options.consent, "Calibrate", {{"options", wanted}});
  if (!result) return result.error();
  const std::string text = result.value().value("calibration", ordered_json::object()).dump();
  auto calibration = calibration_from_json(text, "odomcalibd");
  if (!calibration) return calibration.error();
  return Solved{std::move(calibration).value(), result.value()};
}

// One more motion where the first drive leaves a question open. What it does not improve does not replace
// anything.
Solved second_drive(const Session& session, const MotionOptions& options, Solved first) {
  const auto next = first.body.value("next", ordered_json());
  if (options.one_drive || !next.is_object()) return first;
  const std::string manoeuvre = next.value("manoeuvre", "");
  tell("One more motion, \"" + manoeuvre + "\": " + next.value("why", "") + ".");
  ordered_json wanted = {{"manoeuvre", manoeuvre}, {"with", {first.body.value("recording", "")}}};
  auto second = drive_and_solve(session, options, wanted);
  if (second && second.value().calibration.verdict != Verdict::refused) return std::move(second).value();
  tell("It did not help: " +
       (second ? std::string("the two recordings together were refused") : second.error().text()) +
       ". The first drive counts.");
  return first;
}

// The drive must not be lost with the file: the result was printed, and the daemon has a copy.
int report_lost(Error error, const Solved& solved) {
  const std::filesystem::path recording = solved.body.value("recording", "");
  const auto copy =
      recording.parent_path().parent_path() / "calibrations" / recording.stem().replace_extension(".json");
  error.remedy =
      fmt::format("the result above was not lost: odomcalibd keeps it in {}, and the recording is {}",
                  copy.string(), recording.string());
  return report_error(error, JsonMode::off);
}

// Requirements of --apply beside a calibration: a controller whose odometry shows what was written, and its
// errors before.
Result<std::optional<DriveErrors>> before_apply(const Session& session, const MotionOptions& options,
                                                const RunMethod& run) {
  if (!options.apply) return std::optional<DriveErrors>();
  const auto held = call_once(session.socket, "GetParameters");
  if (!held) return held.error();
  if (auto error = unprovable(held.value().value("parameters", ordered_json::array()))) return *error;
  const auto errors = drive_errors(run);
  if (!errors) return errors.error();
  return std::optional(errors.value());
}

// From the write on until it is proven or taken back no signal ends this program. Should something else end
// it, its connection ends too, and the daemon takes back what is not proven.
Result<ProvenApply> prove(const Session& session, Consent consent, const Calibration& calibration,
                          const DriveErrors& before) {
  auto held = Client::connect(session.socket);
  if (!held) return held.error();
  const SignalsCaught caught;
  const RunMethod run = [&](const std::string& method, ordered_json parameters) {
    const bool writes = method == "Apply" || method == "Store";
    consent.interrupted = writes ? WhenInterrupted::finish : WhenInterrupted::stop;
    consent.on = method == "Apply" ? &held.value() : nullptr;
    consent.yes = consent.yes || method == "Store";  // it was asked for with the write
    return run_method(session, consent, method, std::move(parameters));
  };
  const RunMethod always = [&session](const std::string& method, ordered_json parameters) {
    const Consent nobody_is_asked{.yes = true, .interrupted = WhenInterrupted::begin};
    return run_method(session, nobody_is_asked, method, std::move(parameters));
  };
  return apply_and_prove(run, always, calibration, before);
}

void print_calibration(const Session& session, Calibration calibration,
                       const std::optional<ProvenApply>& applied) {
  if (applied) calibration.proof = entry_of(*applied);
  if (session.json != JsonMode::off) return print_json(to_json(calibration), session.json);
  if (applied) print_text(describe(*applied), session.legend);
}

int calibrate(const Session& session, const MotionOptions& options) {
  // After two minutes of driving it would be too late to find out.
  if (const auto files = check_outputs({{"--out", options.file}}, {}); !files)
    return report_error(files.error(), session.json);
  const ordered_json wanted = {{"quick", options.quick}};
  if (options.consent.dry_run)
    return print_result(session, "plan",
                        run_method(session, options.consent, "Calibrate", {{"options", wanted}}));
  const RunMethod run = [&](const std::string& method, ordered_json parameters) {
    return run_method(session, options.consent, method, std::move(parameters));
  };
  const auto before = before_apply(session, options, run);
  if (!before) return report_error(before.error(), session.json);
  auto solved = drive_and_solve(session, options, wanted);
  if (!solved) return report_error(solved.error(), session.json);
  const Solved best = second_drive(session, options, std::move(solved).value());
  if (session.json == JsonMode::off) {
    Calibration shown = best.calibration;
    if (before.value() && shown.verdict == Verdict::accepted)
      shown.next_step = "these values are tried now, and stored unless odometry is worse with them";
    print_calibration(shown, session);
  }
  if (!options.file.empty())
    if (auto written = write_output(options.file, to_json(best.calibration)); !written)
      return report_lost(written.error(), best);
  std::optional<ProvenApply> applied;
  if (before.value()) {
    auto proven = prove(session, options.consent, best.calibration, *before.value());
    if (!proven) return report_error(proven.error(), session.json);
    applied = std::move(proven).value();
  }
  print_calibration(session, best.calibration, applied);
  if (applied && applied->error) return report_error(*applied->error, JsonMode::off);
  return best.calibration.verdict == Verdict::refused ? kRefused : kDone;
}

int apply(const Session& session, const MotionOptions& options) {
  const auto bytes = read_file_bytes(options.file);
  if (!bytes) return report_error(bytes.error(), session.json);
  auto body = ordered_json::parse(bytes.value(), nullptr, false);
  if (!body.is_object()) return report_error(read_calibration(options.file).error(), session.json);
  body.erase(kPictureMember);
  ordered_json parameters = {{"calibration", std::move(body)}};
  if (options.replaced) parameters["replaced"] = true;
  return print_result(session, "write-back",
                      run_method(session, options.consent, "Apply", std::move(parameters)));
}

// A wire in the wrong place is a failure, one that could not be determined is none.
int check(const Session& session, const MotionOptions& options) {
  if (!options.nudge) return show_checks(session);
  const auto result = run_method(session, options.consent, "Check", {{"nudge", true}});
  if (!result || options.consent.dry_run) return print_result(session, "plan", result);
  const ordered_json& checks = result.value().value("checks", ordered_json::array());
  if (session.json != JsonMode::off)
    print_document("checks", result.value(), session.json);
  else
    print_text(describe_checks(checks), session.legend);
  return result.value()["wiring"].value("outcome", "") == "fail" ? kFailure : kDone;
}

// "NAME=VALUE", in m. Error: usage.
Result<ordered_json> parsed_values(const std::vector<std::string>& assignments) {
  ordered_json values = ordered_json::object();
  for (const auto& text : assignments) {
    const auto equals = text.find('=');
    const auto value =
        equals == std::string::npos ? std::nullopt : number_from<double>(text.substr(equals + 1));
    if (!value || equals == 0 || !std::isfinite(*value))
      return Error{ErrorCode::usage, "not NAME=VALUE with a value in m", text, "odomcalibctl params get"};
    const std::string name = text.substr(0, equals);
    if (values.contains(name)) return Error{ErrorCode::usage, name + " has two values", text, "give it one"};
    values[name] = *value;
  }
  return values;
}

int set_parameters(const Session& session, const MotionOptions& options) {
  const auto values = parsed_values(options.assignments);
  if (!values) return report_error(values.error(), session.json);
  return print_result(session, "write-back",
                      run_method(session, options.consent, "SetParameters", {{"values", values.value()}}));
}

int rollback(const Session& session, const MotionOptions& options) {
  ordered_json parameters = ordered_json::object();
  if (!options.id.empty()) parameters["id"] = options.id;
  if (!options.to.empty()) parameters["to"] = options.to;
  if (options.replaced) parameters["replaced"] = true;
  return print_result(session, "write-back", run_method(session, options.consent, "Rollback", parameters));
}

template <typename Action>
CLI::App* add_action(CLI::App& app, Session& session, const std::shared_ptr<MotionOptions>& options,
                     const char* verb, const char* help, Action action) {
  auto* added = app.add_subcommand(verb, help);
  add_consent(*added, options->consent);
  added->callback([&session, options, action] {
    session.run = [&session, options, action] { return action(session, *options); };
  });
  return added;
}

}  // namespace

void add_motions(CLI::App& app, Session& session) {
  const auto options = std::make_shared<MotionOptions>();
  add_action(app, session, options, "check", "Whether everything needed for a calibration is there", check)
      ->add_flag("--nudge", options->nudge,
                 "move by 5 cm and 15 degrees and back: are wheels, counts and lidar wired as configured?");
  auto* all =
      add_action(app, session, options, "calibrate", "Straight, spin and pattern, then solve", calibrate);
  all->add_flag("--quick", options->quick, "a shorter pattern");
  all->add_flag("--one-drive", options->one_drive, "no second motion, whatever the first leaves open");
  all->add_flag("--apply", options->apply,
                "try it, drive straight and spin again, and store it unless odometry is worse");
  add_output(*all, "--out", options->file, "calibration file to write");
  constexpr const char* kReplaced = "the controller took the place of the one that these values are of";
  auto* write = add_action(app, session, options, "apply", "Write a calibration to the controller", apply);
  write->add_option("CALIBRATION", options->file)->required();
  write->add_flag("--replaced", options->replaced, kReplaced);
  add_action(*app.get_subcommand("params"), session, options, "set", "Write values to the controller",
             set_parameters)
      ->add_option("NAME=VALUE", options->assignments, "in m, e.g. track_width=0.4033")
      ->required();
  auto* back =
      add_action(app, session, options, "rollback", "Restore the values before a write-back", rollback);
  auto* before = back->add_option("ID", options->id,
                                  "history entry before which it goes, default: one further back each time");
  back->add_option("--to", options->to, "history entry whose values it restores")->excludes(before);
  back->add_flag("--replaced", options->replaced, kReplaced);
}

}  // namespace odomcalib::cli
