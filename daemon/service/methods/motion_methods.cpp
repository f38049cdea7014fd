// Guided motions and recordings.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/plans.hpp"
#include "daemon/routines/settings.hpp"
#include "daemon/routines/wiring.hpp"
#include "daemon/safety/clear_space.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/service/call_parameters.hpp"
#include "daemon/service/methods/methods.hpp"
#include "daemon/service/motion_gate.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/status_report.hpp"
#include "daemon/service/tasks/motion_task.hpp"
#include "daemon/service/tasks/reading_task.hpp"
#include "daemon/service/tasks/recording_task.hpp"
#include "drivers/clean_text.hpp"

namespace odomcalib {
namespace {

Error out_of_range(const std::string& what) {
  return {ErrorCode::usage, what, "parameters", "see odomcalibctl(1)"};
}

bool within(double value, double least, double most) { return value >= least && value <= most; }

std::optional<Error> wrong_speed(double speed) {
  if (within(speed, service::settings::kLeastSpeed_m_s, service::settings::kMostSpeed_m_s))
    return std::nullopt;
  return out_of_range("speed is not between 0.02 and 10 m/s");
}

std::optional<Error> wrong_repeat(int repeat) {
  if (repeat >= 1 && repeat <= routines::settings::kMostRepeats) return std::nullopt;
  return out_of_range("repeat is not between 1 and 20");
}

std::optional<Error> wrong_straight(const routines::StraightOptions& options) {
  if (!within(std::abs(options.distance), service::settings::kLeastDistance_m,
              service::settings::kMostDistance_m))
    return out_of_range("distance is not between 0.05 and 5 m");
  if (auto wrong = wrong_speed(options.speed)) return wrong;
  return wrong_repeat(options.repeat);
}

std::optional<Error> wrong_square(const routines::SquareOptions& options) {
  if (!within(options.side, service::settings::kLeastSide_m, service::settings::kMostSide_m))
    return out_of_range("the side of the square is not between 0.3 and 5 m");
  if (auto wrong = wrong_speed(options.speed)) return wrong;
  return wrong_repeat(options.repeat);
}

std::optional<Error> wrong_spin(const routines::SpinOptions& options) {
  if (!within(options.turns, service::settings::kLeastTurns, service::settings::kMostTurns))
    return out_of_range("turns is not between 0.05 and 10");
  if (!within(options.rate, service::settings::kLeastRate_rad_s, service::settings::kMostRate_rad_s))
    return out_of_range("rate is not between 0.05 and 10 rad/s");
  return wrong_repeat(options.repeat);
}

// "with": file names of this daemon's own recordings; nothing outside its folder is read for a client.
Result<std::vector<std::filesystem::path>> earlier_recordings(const ordered_json& given,
                                                              const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  if (!given.is_null() && (!given.is_array() || given.size() > service::settings::kMostEarlier))
    return out_of_range("\"with\" is no list of recordings");
  for (const auto& name : given) {
    const auto file = std::filesystem::path(name.is_string() ? name.get<std::string>() : "").filename();
    std::error_code error;
    if (file.empty() || !std::filesystem::is_regular_file(folder / file, error))
      return out_of_range("no recording \"" + file.string() + "\"");
    paths.push_back(folder / file);
  }
  return paths;
}

// Names of effects to fit; without the member those of the daemon.
std::vector<std::string> wanted_effects(CallParameters& options) {
  const ordered_json& given = options.member("effects");
  if (given.is_null()) return SolveRecording{}.effects;
  std::vector<std::string> names;
  for (const auto& name : given)
    if (name.is_string()) names.push_back(name.get<std::string>());
  if (!given.is_array() || names.empty() || names.size() != given.size()) options.reject("effects");
  return names;
}

// The turns of a spin go to the sides that are named.
void choose_sides(CallParameters& parameters, routines::SpinOptions& options) {
  const std::string direction = parameters.text("direction", "both");
  if (direction != "both" && direction != "cw" && direction != "ccw") parameters.reject("direction");
  options.left = direction != "cw";
  options.right = direction != "ccw";
}

ordered_json json_of(const std::vector<safety::Sector>& sectors) {
  ordered_json list = ordered_json::array();
  for (const auto& sector : sectors) list.push_back({sector.from, sector.to});
  return list;
}

ordered_json json_of(const safety::ClearSpace& space) {
  constexpr std::array kSides = {"ahead", "left", "behind", "right"};
  ordered_json body = {{"cell", space.cell}, {"rows", space.rows}};
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    const auto& one = space.sides.at(side);
    body[kSides.at(side)] = {{"needed", one.needed}, {"nearest", nullptr}};
    if (one.nearest) body[kSides.at(side)]["nearest"] = *one.nearest;
  }
  return body;
}

ordered_json plan_report(const RobotParts& parts, const routines::Plan& plan,
                         const routines::Preview& preview, const std::vector<std::string>& unseen,
                         const std::vector<safety::Sector>& blind) {
  return {{"plan", plan.name},
          {"moves", plan.moves.size()},
          {"duration", preview.duration},
          {"reach", preview.reach},
          {"unseen_moves", unseen},
          {"blind_sectors", json_of(blind)},
          {"limited", routines::limited(plan)},
          {"first_motion", !parts.last_run.moved()},
          {"stopping_distance",
           safety::stopping_distance(plan.limits.speed, parts.surroundings.obstacles.options())},
          {"clear_space", json_of(safety::clear_space(parts.surroundings.points, preview,
                                                      parts.config.footprint, parts.config.clearance))}};
}

struct View {
  safety::BlindArea blind;
  std::vector<std::string> unseen;  ///< moves that go there
};

View view_of(const Surroundings& surroundings, const routines::Plan& plan, double now) {
  const safety::BlindArea blind = surroundings.cover.blind(now);
  return {blind, safety::unseen_moves(plan, blind, surroundings.obstacles.options())};
}

/// Where the lidar sees nothing, nothing but a person stops the robot: one has to stand for it, in this call
/// and for this motion (rule M10). Notes in the order what it is.
std::optional<Error> not_vouched_for(const Surroundings& surroundings, MotionTask::Order& order, double now) {
  const View view = view_of(surroundings, order.plan, now);
  order.unseen.clear();
  if (view.unseen.empty()) return std::nullopt;
  order.unseen = fmt::format("the lidar does not see {} of the robot, and \"{}\" goes there",
                             safety::text_of(view.blind.sectors()), fmt::join(view.unseen, "\", \""));
  if (!order.vouched_by.empty()) return std::nullopt;
  return Error{ErrorCode::refused, order.unseen, "motion",
               "another motion; or somebody watches that area and vouches for it: odomcalibctl asks, other "
               "clients say who (vouched_by)"};
}

MotionTask::Parts for_motion(RobotParts& parts) {
  return {parts.config,     parts.clock,        parts.calibrator, parts.loop,     parts.outbox,
          parts.drive,      parts.surroundings, parts.odometry,   parts.recorded, parts.applied,
          parts.write_back, parts.lease,        parts.last_run};
}

Outcome begin_motion(RobotParts& parts, const Caller& caller, MotionTask::Order order, bool dry_run) {
  routines::Plan& plan = order.plan;
  if (parts.drive.controller().watchdog_armed())
    plan.limits.speed = std::min(routines::capped(plan.limits).speed,
                                 safety::fastest_with(parts.drive.controller().watchdog_time()));
  if (const auto error = too_long(plan)) return *error;
  const auto preview = routines::preview(plan);
  if (const auto error = motion_forbidden(parts, preview)) return *error;
  if (dry_run) {
    if (auto wrong = parts.drive.geometry_forbidden()) return *wrong;
    const View view = view_of(parts.surroundings, plan, parts.now);
    return Answer{{{"result", plan_report(parts, plan, preview, view.unseen, view.blind.sectors())}}};
  }
  if (const auto refused = not_vouched_for(parts.surroundings, order, parts.now)) return *refused;
  for (const auto& text : routines::limited(plan))
    parts.outbox.event(messages::Severity::info, "limited", text);
  ReadingTask::Next next = [&parts, caller, order = std::move(order),
                            preview]() mutable -> Result<std::unique_ptr<Task>> {
    if (const auto error = motion_forbidden(parts, preview)) return *error;
    if (const auto wrong = parts.drive.geometry_forbidden()) return *wrong;
    if (const auto refused = not_vouched_for(parts.surroundings, order, parts.now)) return *refused;
    return MotionTask::begin(for_motion(parts), caller, order, parts.now);
  };
  return begin_reading(parts, caller, std::move(next));
}

Reading motion_request(Context& context, const Call& call, routines::Plan plan, MotionPurpose purpose) {
  CallParameters given(call.parameters);
  const std::string lease = given.text("lease", "");
  const bool dry_run = given.flag("dry_run");
  const std::string vouched_by = drivers::clean_text(given.text("vouched_by", ""));
  if (given.wrong()) return WrongParameter{*given.wrong()};
  MotionTask::Order order{std::move(plan), lease, std::move(purpose),
                          vouched_by.substr(0, service::settings::kLongestName)};
  return Request{lease, dry_run,
                 [&parts = context.parts, caller = call.caller, dry_run, order = std::move(order)] {
                   return begin_motion(parts, caller, order, dry_run);
                 }};
}

const std::vector<std::string> kOfManoeuvre = {"manoeuvre", "quick", "effects", "with"};
const std::vector<std::string> kOfWholeDrive = {"manoeuvre", "quick",  "effects", "with", "distance",
                                                "speed",     "repeat", "turns",   "rate"};

// Straight, spin and pattern as one motion in one recording, or a single manoeuvre that goes with earlier
// recordings.
Result<routines::Plan> calibration_plan(const Config& config, const RobotDescription& robot,
                                        CallParameters& options) {
  const routines::PatternOptions pattern{.area_length = config.area_length,
                                         .area_width = config.area_width,
                                         .track_width = robot.track_width,
                                         .quick = options.flag("quick"),
                                         .limits = config.limits};
  const std::string name = options.text("manoeuvre", "");
  options.only(name.empty() ? kOfWholeDrive : kOfManoeuvre);
  if (!name.empty()) {
    auto plan = routines::manoeuvre_plan(name, pattern);
    if (!plan) return out_of_range("there is no manoeuvre \"" + name + "\"");
    return std::move(*plan);
  }
  routines::StraightOptions straight;
  straight.distance =
      options.number("distance", std::min(service::settings::kUsualStraight_m,
                                          service::settings::kStraightShareOfArea * config.area_length));
  straight.speed = options.number("speed", straight.speed);
  straight.repeat = options.whole("repeat", 1);
  routines::SpinOptions spin;
  spin.turns = options.number("turns", 1.0);
  spin.rate = options.number("rate", spin.rate);
  spin.repeat = straight.repeat;
  if (const auto wrong = wrong_straight(straight)) return *wrong;
  if (const auto wrong = wrong_spin(spin)) return *wrong;
  routines::Plan plan = routines::straight_plan(straight);
  for (const auto& part : {routines::spin_plan(spin), routines::pattern_plan(pattern)})
    plan.moves.insert(plan.moves.end(), part.moves.begin(), part.moves.end());
  plan.name = "calibrate";
  plan.limits = config.limits;
  return plan;
}

}  // namespace

Reading nudge(Context& context, const Call& call) {
  return motion_request(context, call, routines::nudge_plan(context.parts.config.limits),
                        ReportWiring{[&parts = context.parts] { return check_report(parts); }});
}

Reading straight(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  routines::StraightOptions options;
  options.distance = given.number("distance");
  options.speed = given.number("speed", options.speed);
  options.repeat = given.whole("repeat", 1);
  options.one_way = given.flag("one_way");
  (void)given.flag("square");
  options.limits = context.parts.config.limits;
  (void)given.flag("dry_run");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  if (auto wrong = wrong_straight(options)) return *wrong;
  return motion_request(context, call, routines::straight_plan(options), ReportMoves{});
}

Reading square(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  routines::SquareOptions options;
  options.side = given.number("distance");
  options.speed = given.number("speed", options.speed);
  options.repeat = given.whole("repeat", 1);
  options.limits = context.parts.config.limits;
  (void)given.flag("dry_run");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  if (auto wrong = wrong_square(options)) return *wrong;
  return motion_request(context, call, routines::square_plan(options), ReportMoves{routines::kMovesOfSquare});
}

Reading spin(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  routines::SpinOptions options;
  options.turns = given.number("turns");
  options.rate = given.number("rate", options.rate);
  options.repeat = given.whole("repeat", 1);
  options.limits = context.parts.config.limits;
  choose_sides(given, options);
  (void)given.flag("dry_run");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  if (auto wrong = wrong_spin(options)) return *wrong;
  return motion_request(context, call, routines::spin_plan(options), ReportMoves{});
}

Reading calibrate(Context& context, const Call& call) {
  static const ordered_json kNone = ordered_json::object();
  const RobotParts& parts = context.parts;
  CallParameters given(call.parameters);
  (void)given.flag("dry_run");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  const ordered_json& wanted = given.member("options");
  CallParameters options(wanted.is_null() ? kNone : wanted, "options");
  SolveRecording solve{wanted_effects(options), {}};
  auto plan = calibration_plan(parts.config, parts.drive.robot(), options);
  if (options.wrong()) return WrongParameter{*options.wrong()};
  if (parts.calibrator.wrong_effects)
    if (auto wrong = parts.calibrator.wrong_effects(solve.effects)) return *wrong;
  if (!plan) return plan.error();
  auto earlier = earlier_recordings(options.member("with"), parts.config.state_dir / "recordings");
  if (!earlier) return earlier.error();
  solve.earlier = std::move(earlier).value();
  return motion_request(context, call, std::move(plan).value(), std::move(solve));
}

Reading record(Context& context, const Call& call) {
  CallParameters given(call.parameters);
  const double duration = given.number("duration", 0.0);
  const std::string name = given.text("name", "record");
  if (given.wrong()) return WrongParameter{*given.wrong()};
  if (!within(duration, 0.0, service::settings::kLongestRecord_s))
    return out_of_range("duration is not 0 to 3600 s");
  RobotParts& parts = context.parts;
  auto task = RecordingTask::begin({parts.outbox, parts.recorded, parts.write_back}, call.caller,
                                   {name, duration}, parts.now);
  if (!task) return task.error();
  return std::move(task).value();
}

}  // namespace odomcalib
