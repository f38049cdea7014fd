// straight and spin: the robot moves, the lidar or a person says how far, and corrected lengths are proposed.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <numbers>

#include "daemon/cli/answer_documents.hpp"
#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/manual_moves.hpp"
#include "daemon/cli/motion_call.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/verbs.hpp"
#include "daemon/routines/settings.hpp"
#include "proto/angles.hpp"
#include "proto/calibration/utc.hpp"
#include "proto/file_bytes.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

struct ManualOptions {
  Consent consent;
  double distance = 1.0, turns = 1.0;
  bool distance_is_stated = false;
  std::string direction = "both";
  int repeat = 1;
  bool one_way = false, square = false;
  std::vector<std::string> measured;
  std::string of, out;
};

/// One motion of the daemon, and the question that follows it.
struct Motion {
  std::string method;
  ordered_json parameters;
  std::string question;  ///< empty: nothing is asked after it
};

bool asks(const ManualOptions& options) {
  return options.measured.size() == 1 && options.measured[0] == "ask";
}

/// Whether it begins as no number does: the part behind a comma that was meant as a point.
bool is_fraction(const std::string& text) {
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

/// @return in SI
Result<double> number_of(const std::string& text, const Measure& measure) {
  const std::string example =
      fmt::format("state it in {}, with a point, for example {}", measure.unit, measure.example);
  const auto value = number_from<double>(text);
  if (!value || !std::isfinite(*value) || !(*value > 0.0))
    return Error{ErrorCode::usage, "\"" + text + "\" is no number above 0", "what was measured", example};
  if (is_fraction(text))
    return Error{ErrorCode::usage, "\"" + text + "\" is no number, but what follows a decimal point",
                 "what was measured", example};
  return *value * measure.si;
}

/// m or rad, that a motion goes.
double length_of(const Motion& motion) {
  const auto distance = motion.parameters.find("distance");
  return distance != motion.parameters.end()
             ? std::abs(distance->get<double>())
             : 2.0 * std::numbers::pi * std::abs(motion.parameters.value("turns", 0.0));
}

/// @param motion that goes as far as those that were measured
Result<std::vector<double>> measured_values(const ManualOptions& options, const Measure& measure,
                                            const Motion& motion) {
  std::vector<double> values;
  if (asks(options)) return values;
  for (const auto& text : options.measured) {
    const auto value = number_of(text, measure);
    if (!value) return value.error();
    // Before anything moves. What was driven before is looked at with what odometry said of it.
    if (auto wrong =
            options.of.empty() ? implausible(value.value(), length_of(motion), measure) : std::nullopt)
      return *wrong;
    values.push_back(value.value());
  }
  return values;
}

/// Number that a person reads; an answer that is none, or not of this motion, is asked for again.
Result<double> asked(const Motion& motion, const Measure& measure) {
  for (std::string line; std::cerr << motion.question << std::flush, std::getline(std::cin, line);) {
    auto value = number_of(line, measure);
    const auto wrong = value ? implausible(value.value(), length_of(motion), measure) : value.error();
    if (!wrong) return value;
    std::cerr << wrong->what << '\n';
  }
  return Error{ErrorCode::cancelled, "nothing was measured", "standard input", ""};
}

/// Motions of one repetition.
std::vector<Motion> straight_motions(const ManualOptions& options) {
  ordered_json there = {{"distance", options.distance}};
  if (options.square) there["square"] = true;
  if (!options.one_way && !asks(options)) return {{"Straight", there, ""}};
  there["one_way"] = true;
  std::vector<Motion> motions = {{"Straight", there, "Distance from where it stood to where it stands, m: "}};
  if (options.one_way) return motions;
  there["distance"] = -options.distance;
  motions.push_back({"Straight", there, ""});
  return motions;
}

std::vector<Motion> spin_motions(const ManualOptions& options) {
  const auto motion = [&](const std::string& direction) {
    return Motion{"Spin",
                  {{"turns", options.turns}, {"direction", direction}},
                  "Angle that it turned, degrees, whole turns counted: "};
  };
  if (asks(options) && options.direction == "both") return {motion("ccw"), motion("cw")};
  return {motion(options.direction)};
}

using Propose = std::function<Result<Proposal>(const DrivenMoves&, const std::vector<double>&)>;

struct Outcome {
  DrivenMoves driven;
  std::optional<Proposal> proposal;
  ordered_json plan;  ///< with --dry-run only
};

/// Consent is asked for once, and then for every motion of the repetitions given.
Result<ordered_json> move(const Session& session, ManualOptions& options, const Motion& motion) {
  auto result = run_method(session, options.consent, motion.method, motion.parameters);
  if (result) options.consent.yes = true;
  return result;
}

Result<Outcome> drive(const Session& session, ManualOptions options, const std::vector<Motion>& motions,
                      const Measure& measure, std::vector<double> measured, const Propose& propose) {
  Outcome outcome;
  for (int round = 0; round < options.repeat && !(outcome.proposal && outcome.proposal->entry.settled);
       ++round) {
    for (const Motion& motion : motions) {
      const auto result = move(session, options, motion);
      if (!result) return result.error();
      if (options.consent.dry_run) return Outcome{{}, std::nullopt, result.value()};
      if (auto added = outcome.driven.add(result.value()); !added) return added.error();
      if (!asks(options) || motion.question.empty()) continue;
      const auto answer = asked(motion, measure);
      if (!answer) return answer.error();
      measured.push_back(answer.value());
    }
    // One value for each move can only be set beside all of them.
    if (!asks(options) && measured.size() > 1 && round + 1 < options.repeat) continue;
    auto proposal = propose(outcome.driven, measured);
    if (!proposal) return proposal.error();
    outcome.proposal = std::move(proposal).value();
  }
  return outcome;
}

/// The moves driven before, as --json printed them.
Result<DrivenMoves> read_moves(const std::string& path) {
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  DrivenMoves driven;
  auto added = driven.add(ordered_json::parse(bytes.value(), nullptr, false));
  if (!added)
    return Error{ErrorCode::format, added.error().what, path, "a file that --json of the same verb printed"};
  return driven;
}

std::string describe_move(const ordered_json& move) {
  const auto& told = move["odometry"];
  std::string text =
      fmt::format("{}: odometry {:.4f} m, {:.3f} deg", move.value("move", ""),
                  std::hypot(told[0].get<double>(), told[1].get<double>()), told[2].get<double>() * kDegrees);
  if (!move.contains("error") || !move["error"].is_object()) return text + "; no lidar reference";
  return text + fmt::format("; error {:+.1f} mm, {:+.3f} deg",
                            1000.0 * move["error"]["distance"].get<double>(),
                            move["error"]["yaw"].get<double>() * kDegrees);
}

void print_outcome(const Session& session, const Outcome& outcome) {
  const auto& [driven, proposal, plan] = outcome;
  if (!plan.is_null()) {
    session.json == JsonMode::off ? print_text(describe_plan(plan), session.legend)
                                  : print_document("plan", plan, session.json);
    return;
  }
  if (session.json != JsonMode::off) {
    ordered_json body = {{"moves", driven.moves}, {"robot", driven.robot}};
    if (!driven.rounds.empty()) body["rounds"] = driven.rounds;
    body["proposal"] = proposal ? to_json(proposal->entry) : ordered_json(nullptr);
    if (!driven.recordings.empty()) body["recording"] = driven.recordings.back();
    body["recordings"] = driven.recordings;
    if (driven.driven)
      body["driven"] = {{"begin", utc_text(driven.driven->begin)}, {"end", utc_text(driven.driven->end)}};
    return print_document("moves", body, session.json);
  }
  for (const auto& one : driven.moves) print_line(describe_move(one));
  for (const auto& recording : driven.recordings) print_line("recording " + recording);
  if (!proposal) return;
  for (const auto& line : to_lines(proposal->entry)) print_line(line);
  std::cout << wrapped_command("Next: " + next_command(proposal->entry), text_columns());
}

int finish_manual(const Session& session, const ManualOptions& options, const Result<Outcome>& outcome) {
  if (!outcome) return report_error(outcome.error(), session.json);
  print_outcome(session, outcome.value());
  if (options.out.empty() || !outcome.value().proposal) return kDone;
  const auto text = to_json(calibration_of(*outcome.value().proposal, outcome.value().driven));
  if (auto written = write_output(options.out, text); !written)
    return report_error(written.error(), session.json);
  return kDone;
}

/// Drives, or with --of looks again at what was driven before.
int run(const Session& session, const ManualOptions& options, const std::vector<Motion>& motions,
        const Measure& measure, const Propose& propose) {
  if (const auto files = check_outputs({{"--out", options.out}}, {{"--of", options.of}}); !files)
    return report_error(files.error(), session.json);
  auto measured = measured_values(options, measure, motions.front());
  if (!measured) return report_error(measured.error(), session.json);
  if (options.of.empty())
    return finish_manual(session, options,
                         drive(session, options, motions, measure, std::move(measured).value(), propose));
  if (asks(options))
    return report_error({ErrorCode::usage, "nobody is asked about moves that were driven before", "--of",
                         "state what was measured, one value or one for each move"},
                        session.json);
  auto driven = read_moves(options.of);
  if (!driven) return report_error(driven.error(), session.json);
  auto proposal = propose(driven.value(), measured.value());
  if (!proposal) return report_error(proposal.error(), session.json);
  return finish_manual(session, options,
                       Outcome{std::move(driven).value(), std::move(proposal).value(), nullptr});
}

int straight(const Session& session, const ManualOptions& options) {
  if (options.square && (!options.measured.empty() || options.one_way))
    return report_error({ErrorCode::usage, "a square is measured by the lidar, and ends where it began",
                         "--square", "leave --measured and --one-way out"},
                        session.json);
  if (!options.of.empty() && !options.square && options.distance_is_stated)
    return report_error({ErrorCode::usage, "the moves were driven before", "--distance",
                         "leave it out beside --of, where no side of a square is meant"},
                        session.json);
  const auto propose = [&options](const DrivenMoves& driven, const std::vector<double>& measured) {
    if (!options.square) return straight_proposal(driven, measured);
    const bool is_known = options.of.empty() || options.distance_is_stated;
    return square_proposal(driven, is_known ? std::abs(options.distance) : side_of(driven));
  };
  return run(session, options, straight_motions(options), metres(), propose);
}

/// The track width inherits the error of the diameters.
void warn_of_order(const Session& session) {
  const auto status = call_once(session.socket, "GetStatus");
  if (status && !status.value().value("status", ordered_json::object()).value("calibrated", true))
    warn(
        "no calibration is in force: the track width inherits the error of the wheel diameters; straight "
        "first, apply, then spin");
}

int spin(const Session& session, const ManualOptions& options) {
  if (options.of.empty()) warn_of_order(session);
  return run(session, options, spin_motions(options), degrees(), spin_proposal);
}

/// @return --of, which excludes what only a drive heeds
CLI::Option* add_common(CLI::App& verb, const std::shared_ptr<ManualOptions>& options) {
  add_consent(verb, options->consent);
  auto* repeat =
      verb.add_option("--repeat", options->repeat, "times at most; fewer when more would not make it better")
          ->check(whole(1, routines::settings::kMostRepeats))
          ->capture_default_str();
  add_output(verb, "--out", options->out, "calibration file of the lengths proposed, for apply");
  return verb.add_option("--of", options->of, "nothing moves: what --json of an earlier drive printed")
      ->excludes(repeat);
}

}  // namespace

void add_manual(CLI::App& app, Session& session) {
  const auto options = std::make_shared<ManualOptions>();
  auto* line =
      app.add_subcommand("straight", "Drive straight and back, and propose corrected wheel diameters");
  const auto* distance = line->add_option("--distance", options->distance,
                                          "m, negative: backwards; with --square the length of a side")
                             ->check(finite())
                             ->capture_default_str();
  line->add_option("--measured", options->measured,
                   "m, by a tape instead of the lidar: ask, one value, or one for each way out")
      ->delimiter(',');
  auto* one_way =
      line->add_flag("--one-way", options->one_way, "do not come back: to be measured where it stands");
  line->add_flag("--square", options->square,
                 "around a square in both directions: unequal diameters and track width (UMBmark)");
  add_common(*line, options)->excludes(one_way);
  line->callback([&session, options, distance] {
    options->distance_is_stated = distance->count() > 0;
    session.run = [&session, options] { return straight(session, *options); };
  });
  auto* turn = app.add_subcommand("spin", "Turn on the spot, and propose a corrected track width");
  auto* turns =
      turn->add_option("--turns", options->turns, "full turns")->check(finite())->capture_default_str();
  auto* direction =
      turn->add_option("--direction", options->direction)->check(CLI::IsMember({"ccw", "cw", "both"}));
  turn->add_option(
          "--measured-turn", options->measured,
          "degrees, by a mark on the floor instead of the lidar: ask, one value, or one for each turn")
      ->delimiter(',');
  add_common(*turn, options)->excludes(turns)->excludes(direction);
  turn->callback(
      [&session, options] { session.run = [&session, options] { return spin(session, *options); }; });
}

}  // namespace odomcalib::cli
