#include "daemon/cli/manual_moves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/classical/rest_to_rest.hpp"
#include "calib/classical/settings.hpp"
#include "calib/report/settings.hpp"
#include "daemon/cli/display.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/angles.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

using calib::classical::SpinMove;
using calib::classical::SquarePair;
using calib::classical::SquareRun;
using calib::classical::StraightMove;
using calib::math::Repeated;
using nlohmann::ordered_json;

constexpr std::size_t kMovesOfSquare = 8;

/// `count` finite numbers of a member, or nullopt where they are not there.
template <std::size_t count>
std::optional<std::array<double, count>> numbers(const ordered_json& body, const char* name) {
  if (!body.is_object() || !body.contains(name) || !body[name].is_array() || body[name].size() != count)
    return std::nullopt;
  std::array<double, count> values{};
  for (std::size_t k = 0; k < count; ++k) {
    if (!body[name][k].is_number()) return std::nullopt;
    values.at(k) = body[name][k].template get<double>();
  }
  return values;
}

double length(const ordered_json& robot, const char* name) {
  return robot.is_object() && robot.contains(name) && robot[name].is_number() ? robot[name].get<double>()
                                                                              : 0.0;
}

std::string text_member(const ordered_json& body, const char* name) {
  return body.is_object() && body.contains(name) && body[name].is_string() ? body[name].get<std::string>()
                                                                           : "";
}

RobotDescription robot_of(const ordered_json& robot) {
  RobotDescription description;
  for (const BaseQuantity one : kDriveLengths) description.*member_of(one) = length(robot, name_of(one));
  description.ticks_per_rev = length(robot, "ticks_per_rev");
  description.lidar_pose = numbers<3>(robot, "lidar_pose");
  description.robot_id = text_member(robot, "robot_id");
  description.controller = text_member(robot, "controller");
  description.controller_id = text_member(robot, "controller_id");
  return description;
}

/// Time of the drive; nullopt: the daemon's clock told no date.
std::optional<Driven> driven_in(const ordered_json& result) {
  const ordered_json times = result.value("driven", ordered_json());
  const auto begin = utc_from(text_member(times, "begin")), end = utc_from(text_member(times, "end"));
  if (!begin || !end) return std::nullopt;
  return Driven{*begin, *end};
}

calib::wheels::BaseParameters base_of(const RobotDescription& robot) {
  return {robot.left_wheel_diameter / 2.0, robot.right_wheel_diameter / 2.0, robot.track_width, {}};
}

Error malformed(const std::string& what) {
  return {ErrorCode::format, what, "motion", "odomcalibctl and odomcalibd must be of one version"};
}

/// Whether a move goes the way of the first: a person measures the way out.
bool goes_out(const ordered_json& move, double first) {
  return (*numbers<3>(move, "odometry"))[0] * first > 0.0;
}

Error wrong_count(std::size_t values, std::size_t moves) {
  return {ErrorCode::usage, fmt::format("{} values were measured and {} moves were driven", values, moves),
          "", "give one value for all, or one for each; a number has a point, no comma"};
}

Error unseen() {
  return {ErrorCode::refused, "the lidar recognised the place after none of the moves", "scan matching",
          "measure by hand: --measured or --measured-turn"};
}

double chosen(const std::vector<double>& measured, std::size_t k) {
  return measured.size() == 1 ? measured[0] : measured[k];
}

/// @param std below 0: it is not known
void propose_length(Proposal& proposal, BaseQuantity length, double value, double std) {
  const double in_force = nominal_value(proposal.robot, length).value_or(0.0);
  proposal.entry.parameters.push_back({name_of(length), {value, std < 0.0 ? -1.0 : std, "m", in_force}});
}

void propose_diameter(Proposal& proposal, BaseQuantity wheel, const Repeated& radius) {
  propose_length(proposal, wheel, 2.0 * radius.mean, 2.0 * radius.std);
}

void add_error(Proposal& proposal, const char* name, const Repeated& factor) {
  const double spread = factor.std >= 0.0 ? factor.spread : -1.0;
  proposal.entry.errors.push_back({name, {factor.mean, factor.std, spread}});
}

calib::classical::ReferenceError error_of(bool by_tape) {
  return by_tape ? calib::classical::kTapeAndMark : calib::classical::kLidarAtRest;
}

/// Where the spread matters less than what repetitions do not show, they teach nothing more.
bool is_settled(const Repeated& factor) {
  const double of_spread = calib::math::student_factor(std::max<std::size_t>(factor.count, 2) - 1) *
                           factor.spread / std::sqrt(static_cast<double>(factor.count));
  return factor.count >= settings::kFewRepetitions && factor.std > settings::kWholeOverShown * of_spread;
}

Proposal begun(const char* method, bool by_tape, const DrivenMoves& driven) {
  Proposal proposal;
  proposal.entry.method = method;
  proposal.entry.measured_by = by_tape ? "tape" : "lidar";
  proposal.robot = robot_of(driven.robot);
  return proposal;
}

void remark_few(Proposal& proposal) {
  if (proposal.entry.used < settings::kFewRepetitions)
    proposal.entry.remarks.push_back(
        fmt::format("{} {}: the deviation {}; --repeat 3 makes it known", proposal.entry.used,
                    proposal.entry.used == 1 ? "repetition" : "repetitions",
                    proposal.entry.used == 1 ? "is not known" : "is hardly known"));
}

bool is_plausible(double ratio) {
  namespace gate = calib::report::settings;
  return ratio >= gate::kPlausibleLow && ratio <= gate::kPlausibleHigh;
}

/// The gate of a solve holds for lengths alone, too: what is no length of this robot is not proposed.
Result<Proposal> gated(Proposal proposal) {
  for (const auto& [name, q] : proposal.entry.parameters) {
    if (is_plausible(q.value / q.in_force) &&
        !(q.std > calib::report::settings::kMaxRelativeDeviation * q.value))
      continue;
    const bool by_tape = proposal.entry.measured_by == "tape";
    return Error{
        ErrorCode::refused,
        fmt::format("{} would be {:.3f} +- {:.3f} mm, where {:.3f} mm is in force", readable(name),
                    1e3 * q.value, 2e3 * std::max(q.std, 0.0), 1e3 * q.in_force),
        by_tape ? "what was measured" : "scan matching",
        by_tape ? "measure again; numbers have a point, a comma stands between two of them: 1.0132,1.0128"
                : "check the lengths in force and the wires: odomcalibctl params get, check --nudge"};
  }
  return proposal;
}

Result<std::vector<StraightMove>> straights_by_tape(const DrivenMoves& driven,
                                                    const std::vector<double>& measured) {
  std::vector<StraightMove> moves;
  const double first = driven.moves.empty() ? 0.0 : (*numbers<3>(driven.moves[0], "odometry"))[0];
  std::vector<const ordered_json*> out;
  for (const auto& move : driven.moves)
    if (goes_out(move, first)) out.push_back(&move);
  if (measured.size() != 1 && measured.size() != out.size()) return wrong_count(measured.size(), out.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    const auto wheels = *numbers<2>(*out[k], "wheels");
    const auto odometry = *numbers<3>(*out[k], "odometry");
    if (auto wrong = implausible(chosen(measured, k), std::hypot(odometry[0], odometry[1]), metres()))
      return *wrong;
    moves.push_back({{wheels[0], wheels[1]}, chosen(measured, k), std::nullopt});
  }
  return moves;
}

std::vector<StraightMove> straights_by_lidar(const DrivenMoves& driven) {
  std::vector<StraightMove> moves;
  for (const auto& move : driven.moves) {
    const auto seen = numbers<3>(move, "lidar");
    const auto wheels = *numbers<2>(move, "wheels");
    if (seen) moves.push_back({{wheels[0], wheels[1]}, std::hypot((*seen)[0], (*seen)[1]), (*seen)[2]});
  }
  return moves;
}

/// Eight moves of one direction and the lidar's view of the whole.
std::optional<SquareRun> run_of(const DrivenMoves& driven, std::size_t round) {
  const auto seen = numbers<3>(driven.rounds[round], "lidar");
  if (!seen || (round + 1) * kMovesOfSquare > driven.moves.size()) return std::nullopt;
  SquareRun run;
  for (std::size_t k = round * kMovesOfSquare; k < (round + 1) * kMovesOfSquare; ++k) {
    const auto wheels = *numbers<2>(driven.moves[k], "wheels");
    run.moves.push_back({wheels[0], wheels[1]});
  }
  run.end = {(*seen)[0], (*seen)[1], (*seen)[2]};
  return run;
}

std::string percent(double factor) { return fmt::format("{:+.3f} %", 100.0 * (factor - 1.0)); }

}  // namespace

Result<void> DrivenMoves::add(const ordered_json& result) {
  if (!result.is_object() || !result.contains("moves") || !result["moves"].is_array() ||
      !result.contains("robot"))
    return malformed("no moves of a robot");
  const RobotDescription given = robot_of(result["robot"]);
  if (!(given.left_wheel_diameter > 0.0 && given.right_wheel_diameter > 0.0 && given.track_width > 0.0 &&
        given.ticks_per_rev > 0.0))
    return malformed("no lengths of a robot");
  if (!robot.empty() && robot != result["robot"])
    return malformed("the robot's lengths changed between two motions");
  for (const auto& move : result["moves"]) {
    if (!numbers<3>(move, "odometry") || !numbers<2>(move, "wheels"))
      return malformed("a move without wheels");
    moves.push_back(move);
  }
  robot = result["robot"];
  if (result.contains("rounds"))
    for (const auto& round : result["rounds"]) rounds.push_back(round);
  if (result.contains("recording") && result["recording"].is_string())
    recordings.push_back(result["recording"]);
  if (const auto times = driven_in(result))
    driven = Driven{driven ? std::min(driven->begin, times->begin) : times->begin,
                    driven ? std::max(driven->end, times->end) : times->end};
  return {};
}

const Measure& metres() {
  static const Measure measure{
      "m", 1.0, "1.0132", {{"mm", 1e-3}, {"cm", 1e-2}, {"inches", 0.0254}, {"feet", 0.3048}}};
  return measure;
}

const Measure& degrees() {
  static const Measure measure{"degrees", 1.0 / kDegrees, "361.5", {{"rad", kDegrees}, {"turns", 360.0}}};
  return measure;
}

std::optional<Error> implausible(double measured, double expected, const Measure& measure) {
  const double ratio = measured / expected;
  if (!(expected > 0.0) || is_plausible(ratio)) return std::nullopt;
  const auto far = [ratio](const Measure::OtherUnit& unit) {
    return std::abs(std::log(ratio * unit.in_this));
  };
  const auto meant = *std::min_element(measure.others.begin(), measure.others.end(),
                                       [&](const auto& a, const auto& b) { return far(a) < far(b); });
  std::string text = fmt::format("{:.6g} {} was measured of a move of {:.4g} {}", measured / measure.si,
                                 measure.unit, expected / measure.si, measure.unit);
  if (is_plausible(ratio * meant.in_this))
    text += fmt::format(": in {} that is {:.6g} {}", meant.name, measured * meant.in_this / measure.si,
                        measure.unit);
  return Error{ErrorCode::usage, text, "what was measured",
               fmt::format("state it in {}, for example {}", measure.unit, measure.example)};
}

Result<Proposal> straight_proposal(const DrivenMoves& driven, const std::vector<double>& measured) {
  const bool by_tape = !measured.empty();
  auto moves = by_tape ? straights_by_tape(driven, measured) : Result(straights_by_lidar(driven));
  if (!moves) return moves.error();
  if (moves.value().empty()) return unseen();
  Proposal proposal = begun("straight", by_tape, driven);
  const auto radii =
      calib::classical::propose_radii(moves.value(), base_of(proposal.robot), error_of(by_tape));
  if (!radii) return radii.error();
  const auto& found = radii.value();
  propose_diameter(proposal, BaseQuantity::left_wheel_diameter, found.left);
  propose_diameter(proposal, BaseQuantity::right_wheel_diameter, found.right);
  add_error(proposal, "E_s", found.scale);
  if (found.diameters) add_error(proposal, "E_d", *found.diameters);
  proposal.entry.used = moves.value().size();
  if (!by_tape) proposal.entry.left_out = driven.moves.size() - proposal.entry.used;
  proposal.entry.settled = is_settled(found.scale);
  if (by_tape)
    proposal.entry.remarks.emplace_back(
        "a tape shows no heading: both wheels got one factor, unequal wheels stay hidden");
  remark_few(proposal);
  return gated(std::move(proposal));
}

Result<Proposal> spin_proposal(const DrivenMoves& driven, const std::vector<double>& measured) {
  const bool by_tape = !measured.empty();
  if (by_tape && measured.size() != 1 && measured.size() != driven.moves.size())
    return wrong_count(measured.size(), driven.moves.size());
  std::vector<SpinMove> turns;
  for (std::size_t k = 0; k < driven.moves.size(); ++k) {
    const auto seen = numbers<3>(driven.moves[k], "lidar");
    const auto wheels = *numbers<2>(driven.moves[k], "wheels");
    const double turned = (*numbers<3>(driven.moves[k], "odometry"))[2];
    const double way = turned > 0.0 ? 1.0 : -1.0;
    if (auto wrong = by_tape ? implausible(chosen(measured, k), std::abs(turned), degrees()) : std::nullopt)
      return *wrong;
    if (by_tape)
      turns.push_back({{wheels[0], wheels[1]}, way * chosen(measured, k)});
    else if (seen)
      turns.push_back({{wheels[0], wheels[1]}, (*seen)[2]});
  }
  if (turns.empty()) return unseen();
  Proposal proposal = begun("spin", by_tape, driven);
  const auto track = calib::classical::propose_track_width(turns, base_of(proposal.robot), error_of(by_tape));
  if (!track) return track.error();
  const Repeated& width = track.value().track_width;
  propose_length(proposal, BaseQuantity::track_width, width.mean, width.std);
  add_error(proposal, "E_b", track.value().track);
  proposal.entry.used = turns.size();
  proposal.entry.left_out = driven.moves.size() - turns.size();
  proposal.entry.settled = is_settled(track.value().track);
  proposal.entry.remarks.push_back(
      fmt::format("the diameters in force are taken as right to {:.2f} %, as straight leaves them",
                  100.0 * calib::classical::settings::kDiametersOfStraight));
  remark_few(proposal);
  return gated(std::move(proposal));
}

double side_of(const DrivenMoves& driven) {
  double longest = 0.0;
  for (const auto& move : driven.moves)
    if (const auto& told = move["odometry"]; told.is_array())
      longest = std::max(longest, std::hypot(told[0].get<double>(), told[1].get<double>()));
  return longest;
}

Result<Proposal> square_proposal(const DrivenMoves& driven, double side) {
  std::vector<SquarePair> pairs;
  const std::size_t count = driven.rounds.size() / 2;
  if (count == 0)
    return Error{ErrorCode::usage, "no squares were driven", "--square",
                 "leave it out, or drive: odomcalibctl straight --square"};
  for (std::size_t k = 0; k < count; ++k) {
    const auto ccw = run_of(driven, 2 * k), cw = run_of(driven, 2 * k + 1);
    if (ccw && cw) pairs.push_back({*ccw, *cw});
  }
  if (pairs.empty()) return unseen();
  Proposal proposal = begun("square", false, driven);
  const auto base = base_of(proposal.robot);
  const auto result = calib::classical::propose_from_squares(pairs, base, side);
  if (!result) return result.error();
  const auto& found = result.value();
  const auto lengths = calib::classical::with_errors(base, {1.0, found.diameters.mean, found.track.mean});
  // With the mean fixed, each wheel moves by half of what their ratio moves; the mean is as good as the
  // straight line that gave it.
  const auto add = [&](BaseQuantity wheel, double radius) {
    const double std =
        std::hypot(found.diameters.std, 2.0 * calib::classical::settings::kDiametersOfStraight) * radius;
    propose_length(proposal, wheel, 2.0 * radius, found.diameters.std < 0.0 ? -1.0 : std);
  };
  add(BaseQuantity::left_wheel_diameter, lengths.left_radius);
  add(BaseQuantity::right_wheel_diameter, lengths.right_radius);
  propose_length(proposal, BaseQuantity::track_width, lengths.track_width,
                 found.track.std * base.track_width);
  add_error(proposal, "E_d", found.diameters);
  add_error(proposal, "E_b", found.track);
  proposal.entry.used = pairs.size();
  proposal.entry.left_out = count - pairs.size();
  proposal.entry.settled = is_settled(found.diameters) && is_settled(found.track);
  proposal.entry.remarks.push_back(fmt::format("by the first-order formulae: E_d {:.5f}, E_b {:.5f}",
                                               found.formula.diameters, found.formula.track));
  proposal.entry.remarks.push_back(fmt::format(
      "mean end of a square: {:.1f} mm from where odometry says, {:.1f} mm with the lengths proposed",
      1e3 * found.farthest_before, 1e3 * found.farthest_after));
  proposal.entry.remarks.emplace_back(
      "a closed figure does not show the common scale of the wheels: straight does");
  remark_few(proposal);
  return gated(std::move(proposal));
}

std::string next_command(const ProposalEntry& proposal) {
  std::string command = "odomcalibctl params set";
  for (const auto& [name, q] : proposal.parameters) command += fmt::format(" {}={:.7f}", name, q.value);
  return command;
}

std::vector<std::string> to_lines(const ProposalEntry& proposal) {
  std::vector<std::string> lines;
  for (const auto& [name, q] : proposal.parameters) {
    std::string line = fmt::format("{}: {:.3f} -> {:.3f}", readable(name), 1e3 * q.in_force, 1e3 * q.value);
    if (q.std >= 0.0) line += fmt::format(" +- {:.3f}", 2e3 * q.std);
    lines.push_back(line + fmt::format(" mm ({})", percent(q.value / q.in_force)));
  }
  for (const auto& [name, q] : proposal.errors) {
    std::string line = fmt::format("{} {:.5f}", name, q.value);
    if (q.std >= 0.0)
      line += fmt::format(" +- {:.5f}, spread of one repetition {:.5f}", 2.0 * q.std, q.spread);
    lines.push_back(line);
  }
  lines.push_back(fmt::format(
      "by {}, from {}{}{}", proposal.measured_by, proposal.used,
      proposal.method == "square" ? " squares both ways" : " moves",
      proposal.left_out > 0 ? fmt::format(", {} without a lidar match left out", proposal.left_out) : ""));
  lines.insert(lines.end(), proposal.remarks.begin(), proposal.remarks.end());
  return lines;
}

Calibration calibration_of(const Proposal& proposal, const DrivenMoves& driven) {
  Calibration calibration;
  const ProposalEntry& entry = proposal.entry;
  calibration.robot = proposal.robot;
  calibration.driven = driven.driven;
  for (const auto& [name, q] : entry.parameters)
    calibration.parameters.emplace_back(name, Quantity{q.value, q.std, q.unit});
  calibration.verdict = Verdict::accepted_with_warnings;
  calibration.reasons = {
      fmt::format("lengths of {} alone, by {}: {} repetitions, no other error was looked for", entry.method,
                  entry.measured_by, entry.used)};
  calibration.reasons.insert(calibration.reasons.end(), entry.remarks.begin(), entry.remarks.end());
  for (const std::string& recording : driven.recordings) {
    DataUse use;
    use.name = recording.substr(recording.find_last_of('/') + 1);
    calibration.data.push_back(use);
  }
  calibration.next_step =
      "odomcalibctl apply writes these lengths; odomcalibctl calibrate looks for the other errors";
  calibration.proposal = entry;
  return calibration;
}

}  // namespace odomcalib::cli
