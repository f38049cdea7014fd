// Guided motions: what must be true before one, and what came of it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "daemon/service/service_impl.hpp"

namespace odomcalib {
namespace {

Error forbidden(ErrorCode code, const std::string& what, const std::string& remedy) {
  return {code, what, "motion", remedy};
}

constexpr double kNoticedPause = 0.050;  // s between control steps that are due every 10 ms
constexpr double kLongestPause = 0.200;  // s; M1

constexpr double kLongestPlan = 1800.0;  // s; a preview of it takes some 10 ms of the loop

std::optional<Error> too_long(const routines::Plan& plan) {
  double duration = 0.0;
  for (const auto& move : plan.moves) duration += routines::expected_duration(move, plan.limits);
  if (duration <= kLongestPlan) return std::nullopt;
  return forbidden(ErrorCode::usage,
                   fmt::format("this would take {:.0f} minutes, 30 are allowed", duration / 60.0),
                   "less distance, fewer turns or repetitions, or faster");
}

ordered_json json_of(const routines::Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

ordered_json json_of(const std::vector<safety::Sector>& sectors) {
  ordered_json list = ordered_json::array();
  for (const auto& sector : sectors) list.push_back({sector.from, sector.to});
  return list;
}

}  // namespace

routines::WheelGeometry Service::Impl::geometry() const {
  const RobotDescription all = robot();
  return {all.left_wheel_diameter, all.right_wheel_diameter, all.track_width};
}

// Speeds are wheel rates times diameters: with wrong diameters the cap of M7 is none. What the controller
// holds goes before the configuration, so it has to be known and likely.
std::optional<Error> Service::Impl::geometry_forbidden() const {
  const auto held = base.controller().capabilities();
  const bool readable = std::any_of(held.begin(), held.end(), [](const auto& one) { return one.readable; });
  if (readable && !parameters_known)
    return forbidden(ErrorCode::device, "the controller's values were not read yet",
                     "wait two seconds; if it stays, check the bus");
  const RobotDescription expected = nominal(), all = robot();
  if (!(all.left_wheel_diameter > 0.0 && all.right_wheel_diameter > 0.0 && all.track_width > 0.0))
    return forbidden(ErrorCode::missing_units, "wheel diameters or track width are not known",
                     "state robot.wheel_diameter and robot.track_width in the configuration");
  const std::array<std::tuple<const char*, double, double>, 3> values{
      {{"left_wheel_diameter", all.left_wheel_diameter, expected.left_wheel_diameter},
       {"right_wheel_diameter", all.right_wheel_diameter, expected.right_wheel_diameter},
       {"track_width", all.track_width, expected.track_width}}};
  for (const auto& [name, value, wanted] : values)
    if (wanted > 0.0 && std::abs(value / wanted - 1.0) > kPlausible)
      return forbidden(ErrorCode::refused,
                       fmt::format("the controller holds {} = {:.4f} m, the configuration says {:.4f} m",
                                   name, value, wanted),
                       "measure the robot; correct robot.* in the configuration or the profile, or the "
                       "controller's value");
  return std::nullopt;
}

std::optional<Error> Service::Impl::motion_forbidden(const routines::Preview& preview) const {
  using drivers::ControllerState;
  if (operator_needed)
    return forbidden(ErrorCode::write_unknown,
                     "an interrupted write-back has left the controller's values unknown",
                     "connect the controller and restart odomcalibd, then see odomcalibctl params get");
  const auto state = base.controller().state();
  // A drive in fault that is configured may be started again: enabling it by hand resets the fault.
  const bool faulty = state == ControllerState::fault && base.controller().watchdog_armed();
  if (state != ControllerState::disabled && state != ControllerState::enabled && !faulty)
    return forbidden(ErrorCode::device, "controller is " + name_of(state), "see odomcalibctl check");
  if (!base.controller().watchdog_armed())
    return forbidden(ErrorCode::device, "the controller would not stop by itself if this program died",
                     "use a profile with a watchdog (heartbeat consumer or communication-loss time)");
  if (const auto stale = encoders.stale(now))
    return forbidden(ErrorCode::device, *stale, "see odomcalibctl check");
  if (const auto stale = scans.stale(now))
    return forbidden(ErrorCode::device, *stale, "see odomcalibctl check");
  if (auto wrong = geometry_forbidden()) return wrong;
  if (const auto way = safety::occupied(newest_points, preview, config.footprint, config.clearance))
    return forbidden(ErrorCode::refused, *way, "clear the area, or move the robot");
  return std::nullopt;
}

void Service::Impl::start_motion(const IncomingCall& incoming, const routines::Plan& plan,
                                 const ordered_json& parameters, PendingCall call) {
  const bool dry_run = parameters.value("dry_run", ordered_json(false)) == true;
  if (!dry_run && !lease.holds(call.lease))
    return refuse(incoming.client,
                  forbidden(ErrorCode::not_permitted, "no lease", "acquire one and keep it alive"));
  if (const auto error = too_long(plan)) return refuse(incoming.client, *error);
  const auto preview = routines::preview(plan);
  if (const auto error = motion_forbidden(preview)) return refuse(incoming.client, *error);
  const auto unseen = safety::unseen_moves(plan, cover.blind(now), obstacles.options());
  if (dry_run)
    return answer(incoming.client, {{"result",
                                     {{"plan", plan.name},
                                      {"moves", plan.moves.size()},
                                      {"duration", preview.duration},
                                      {"reach", preview.reach},
                                      {"unseen_moves", unseen},
                                      {"blind_sectors", json_of(cover.blind(now).sectors())}}}});
  if (!unseen.empty())
    event(messages::Severity::warning, "lidar_blind",
          fmt::format("the lidar does not see {} of the robot, and \"{}\" goes there",
                      safety::text_of(cover.blind(now).sectors()), fmt::join(unseen, "\", \"")));
  const auto path = telemetry.recorder.start(fmt::format("{}-{}", plan.name, clock.wall_us() / 1'000'000));
  if (!path) return refuse(incoming.client, path.error());
  recording_path = path.value();
  next_robot = now;
  serve_telemetry();
  agreement_scan.reset();
  disagreement.reset();
  disagreements = 0;
  loop.motion_begins();
  stepped_at = now;
  suspended_at = clock.suspended();
  pending = std::move(call);
  run.emplace(MotionRun::Options{.plan = plan,
                                 .geometry = geometry(),
                                 .countdown = config.countdown,
                                 .now = now,
                                 .flush = [this] { base.flush(); }},
              base.controller());
  event(messages::Severity::info, "motion", plan.name + " begins");
}

// While the loop is held up, nobody steers. The drive's own watchdog stops it after 200 ms without us (M1);
// so do we, and say what it was. What is shorter is told. A machine that was suspended is no exception: what
// it woke up to is not what it had seen (M12).
void Service::Impl::watch_loop() {
  const double slept = clock.suspended() - std::exchange(suspended_at, clock.suspended());
  if (slept > kLongestPause)
    return run->stop({ErrorCode::protective_stop,
                      fmt::format("the machine was suspended for {:.1f} s", slept), "daemon",
                      "look where the robot is, then start again by hand"});
  const double pause = now - std::exchange(stepped_at, now);
  if (pause < kNoticedPause) return;
  const auto& longest = loop.in_motion();
  const std::string text =
      fmt::format("the daemon was held up for {:.0f} ms (in \"{}\")", 1e3 * pause, longest.part);
  ++late_steps;
  if (pause < kLongestPause) return event(messages::Severity::warning, "loop_late", text);
  run->stop({ErrorCode::protective_stop, text, "daemon",
             "see \"loop\" in odomcalibctl status --json; relieve the processor"});
}

// Names both sides: how old the last renewal is, and how long nobody here looked.
std::optional<std::string> Service::Impl::lapsed() const {
  if (lease.holds(pending ? pending->lease : "")) return std::nullopt;
  const auto& longest = loop.in_motion();
  return fmt::format(
      "the client stopped or no longer renews its lease: last renewal {:.0f} ms ago (the longest turn of the "
      "daemon's loop in this motion was {:.0f} ms, in \"{}\", {:.1f} s ago)",
      1e3 * lease.age(now), 1e3 * longest.seconds, longest.part, now - longest.at);
}

// Rule M9. The newest scan against one from a quarter of a metre or 30 degrees before.
void Service::Impl::watch_agreement(const Scan& scan) {
  if (!calibrator.match) return;
  const auto moved = agreement_scan ? relative(agreement_pose, odometry.pose()) : routines::Pose{};
  const bool judge = std::hypot(moved.x, moved.y) > 0.25 || std::abs(moved.yaw) > 0.6;
  if (agreement_scan && !judge) return;
  if (agreement_scan) {
    auto seen = calibrator.match(*agreement_scan, scan, moved, config.lidar_pose);
    // Odometry that is far from the truth is no guess: swapped sides turn the wrong way.
    if (!seen) seen = calibrator.match(*agreement_scan, scan, {}, config.lidar_pose);
    const auto why = seen ? safety::disagreement(moved, *seen) : std::nullopt;
    // One bad match must not stop the robot; two in a row are a fact. The second judge is the next scan.
    disagreements = why ? disagreements + 1 : 0;
    if (disagreements >= 2) disagreement = why;
    if (why) return;
  }
  agreement_scan = scan;
  agreement_pose = odometry.pose();
}

// Odometry and lidar of one move, both from rest to rest. Base motion in the frame of the move's start.
ordered_json Service::Impl::leg_report(const Leg& leg) const {
  const auto told = relative(leg.before, leg.after);
  ordered_json body = {
      {"move", leg.move.name}, {"begin", leg.begin}, {"end", leg.end}, {"odometry", json_of(told)}};
  body["lidar"] = nullptr;
  body["error"] = nullptr;
  if (!calibrator.match || !leg.scan_before || !leg.scan_after) return body;
  const auto lidar_pose =
      active && active->parameter("lidar_x")
          ? std::array{*active->parameter("lidar_x"), active->parameter("lidar_y").value_or(0.0),
                       active->parameter("lidar_yaw").value_or(0.0)}
          : config.lidar_pose;
  auto seen = calibrator.match(*leg.scan_before, *leg.scan_after, told, lidar_pose);
  if (!seen) return body;
  // The lidar cannot count full turns: the nearest to what the odometry says.
  const double difference = routines::wrapped(seen->yaw - told.yaw);
  seen->yaw = told.yaw + difference;
  body["lidar"] = json_of(*seen);
  body["error"] = {{"distance", std::hypot(told.x, told.y) - std::hypot(seen->x, seen->y)},
                   {"yaw", -difference}};
  return body;
}

// What came of the motion, beside its recording.
ordered_json Service::Impl::motion_report() const {
  if (run->error() || !pending || pending->method == "Calibrate") return ordered_json::object();
  if (pending->method == "Check") return nudge_report(run->legs());
  ordered_json legs = ordered_json::array();
  for (const Leg& leg : run->legs()) legs.push_back(leg_report(leg));
  return {{"moves", legs}};
}

void Service::Impl::motion_ended() {
  const auto error = run->error();
  const ordered_json report = motion_report();
  run.reset();
  encoders.commanded(0.0, 0.0, now);
  if (error) {
    telemetry.recorder.finish({});
    last_stop = error->text();
    event(messages::Severity::stop, "stopped", error->text());
    return fail_pending(*error);
  }
  // The disk takes its time; whoever asked gets the answer when the recording is whole.
  telemetry.recorder.finish(
      [this, report](const Result<std::filesystem::path>& path) { recording_written(path, report); });
  event(messages::Severity::info, "motion", "motion finished");
}

void Service::Impl::recording_written(const Result<std::filesystem::path>& path, ordered_json report) {
  if (!path) return fail_pending(path.error());
  if (!pending || pending->method != "Calibrate") {
    report["recording"] = path.value().string();
    return finish_pending(report);
  }
  auto recordings = pending->earlier;
  recordings.push_back(path.value());
  const auto kept = config.state_dir / "calibrations" / (path.value().stem().string() + ".json");
  solve_cancelled = std::make_shared<std::atomic<bool>>(false);
  solver.emplace(cancellable(calibrator, solve_cancelled), std::move(recordings), pending->effects, kept);
}

}  // namespace odomcalib
