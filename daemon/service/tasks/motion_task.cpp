#include "daemon/service/tasks/motion_task.hpp"

#include <fmt/format.h>

#include "daemon/service/leg_report.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/tasks/solving_task.hpp"

namespace odomcalib {
Result<std::unique_ptr<Task>> MotionTask::begin(const Parts& parts, const Caller& caller, Order order,
                                                double now) {
  Outbox& outbox = parts.outbox;
  const auto path = outbox.telemetry.recorder.start(
      fmt::format("{}-{}", order.plan.name, parts.clock.wall_us() / 1'000'000));
  if (!path) return path.error();
  parts.recorded = {};
  outbox.send_robot(parts.drive.described());
  parts.loop.motion_begins();
  parts.last_run.begins(order.plan.name);
  parts.surroundings.braking.begins();
  const std::string name = order.plan.name;
  // Recorded with the motion, and over with it.
  if (!order.unseen.empty())
    outbox.event(messages::Severity::warning, "vouched",
                 fmt::format("{} vouches for this motion, asked for by {}: {}", order.vouched_by,
                             outbox.server.name_of(caller.client), order.unseen));
  std::unique_ptr<Task> task(new MotionTask(parts, caller, std::move(order), now));
  outbox.event(messages::Severity::info, "motion",
               name + " begins, for " + outbox.server.name_of(caller.client));
  return task;
}

MotionTask::MotionTask(const Parts& parts, const Caller& waits, Order order, double now)
    : Task(waits),
      parts_(parts),
      lease_(std::move(order.lease)),
      purpose_(std::move(order.purpose)),
      limited_(routines::limited(order.plan)),
      speed_(order.plan.limits),
      stepped_at_(now),
      suspended_at_(parts.clock.suspended()) {
  run_.emplace(MotionRun::Options{.plan = std::move(order.plan),
                                  .geometry = parts.drive.geometry(),
                                  .countdown = parts.config.countdown,
                                  .now = now,
                                  .flush = [&drive = parts.drive] { drive.link.flush(); }},
               parts.drive.controller());
}

std::string MotionTask::activity() const {
  if (run_) return "moving: " + run_->activity();
  return parts_.write_back.busy() ? "reading or writing parameters" : "writing the recording";
}

void MotionTask::stop(double /*now*/) {
  if (run_) run_->stop({ErrorCode::cancelled, "stopped on request", "motion", "start again"});
}

void MotionTask::abandoned(double /*now*/) {
  if (run_) run_->stop({ErrorCode::cancelled, "the client closed its connection", "motion", "start again"});
}

void MotionTask::drive_stopped(const std::string& why) {
  if (run_) run_->fault(why);
}

void MotionTask::scanned(const Scan& scan) {
  if (!run_) return;
  run_->seen(scan);
  if (run_->driving())
    agreement_.seen(scan, parts_.odometry.at(middle_of(scan)), parts_.calibrator, parts_.config.lidar_pose);
}

TaskTurn MotionTask::daemon_ends(const Error& why, double now) {
  if (!run_) return Running{};
  run_->stop(why);
  return ended(now);
}

TaskTurn MotionTask::turn(double now) {
  if (!run_) return reported();
  if (now < next_step_) return Running{};
  next_step_ = now + service::settings::kControlStep_s;
  watch_loop(now);
  if (const auto problem = parts_.outbox.telemetry.recorder.problem()) run_->stop(*problem);
  // A nudge finds out what the counts are worth: they are held to the limits, not to the command.
  const bool nudge = std::holds_alternative<ReportWiring>(purpose_);
  const routines::Twist commanded =
      nudge ? routines::Twist{routines::kCaps.speed, routines::kCaps.turn_rate} : run_->twist();
  speed_.seen(parts_.drive.newest_ticks.t, parts_.odometry.pose(), commanded);
  parts_.surroundings.braking.seen(parts_.drive.newest_ticks.t, parts_.odometry.pose(), run_->twist());
  run_->step(situation(now));
  const auto rates = routines::to_wheels(run_->twist(), parts_.drive.geometry());
  parts_.drive.encoders.commanded(rates.left, rates.right, now);
  if (run_->ended()) return ended(now);
  parts_.outbox.progress(caller, run_->activity(), run_->fraction(), run_->remaining());
  return Running{};
}

Situation MotionTask::situation(double now) const {
  const auto encoders = parts_.drive.encoders.stale(now);
  return {.now = now,
          .odometry = parts_.odometry.pose(),
          .ticks = parts_.drive.newest_ticks,
          .lapsed = lapsed(now),
          .stale = encoders ? encoders : parts_.surroundings.scans.stale(now),
          .disagreement = agreement_.disagreement(),
          .by_lidar = agreement_.motion(),
          .too_fast = speed_.too_fast(),
          .obstacle = parts_.surroundings.obstacles.obstacle()};
}

// While the loop is held up, nobody steers. The drive's own watchdog stops it after 200 ms without us (M1);
// so do we, and say what it was. A shorter one is reported. A machine that was suspended is no exception:
// what it woke up to is not what it had seen (M12).
void MotionTask::watch_loop(double now) {
  const double slept = parts_.clock.suspended() - std::exchange(suspended_at_, parts_.clock.suspended());
  if (slept > service::settings::kLongestPause_s)
    return run_->stop({ErrorCode::protective_stop,
                       fmt::format("the machine was suspended for {:.1f} s", slept), "daemon",
                       "look where the robot is, then start again by hand"});
  const double pause = now - std::exchange(stepped_at_, now);
  if (pause < service::settings::kNoticedPause_s) return;
  const auto& longest = parts_.loop.in_motion();
  const std::string text =
      fmt::format("the daemon was held up for {:.0f} ms (in \"{}\")", 1e3 * pause, longest.part);
  parts_.loop.step_was_late();
  if (pause < service::settings::kLongestPause_s)
    return parts_.outbox.event(messages::Severity::warning, "loop_late", text);
  run_->stop({ErrorCode::protective_stop, text, "daemon",
              "see \"loop\" in odomcalibctl status --json; relieve the processor"});
}

// Names both sides: how old the last renewal is, and how long nobody here looked.
std::optional<std::string> MotionTask::lapsed(double now) const {
  if (parts_.lease.holds(lease_)) return std::nullopt;
  const auto& longest = parts_.loop.in_motion();
  return fmt::format(
      "the client stopped or no longer renews its lease: last renewal {:.0f} ms ago (the longest turn of the "
      "daemon's loop in this motion was {:.0f} ms, in \"{}\", {:.1f} s ago)",
      1e3 * parts_.lease.age(now), 1e3 * longest.seconds, longest.part, now - longest.at);
}

TaskTurn MotionTask::ended(double now) {
  const auto error = run_->error();
  if (!error) begin_report();
  run_.reset();
  parts_.drive.encoders.commanded(0.0, 0.0, now);
  if (error) {
    parts_.outbox.telemetry.recorder.finish({});
    parts_.last_run.stopped(error->text());
    parts_.outbox.event(messages::Severity::stop, "stopped", error->text());
    return Failed{*error};
  }
  parts_.last_run.ends();
  // The disk takes its time; whoever asked gets the answer when the recording is whole.
  written_.finish(parts_.outbox.telemetry.recorder);
  parts_.outbox.event(messages::Severity::info, "motion", "motion finished");
  return Running{};
}

void MotionTask::begin_report() {
  report_ = ordered_json::object();
  if (const auto* moves = std::get_if<ReportMoves>(&purpose_))
    moves_.emplace(parts_.calibrator, run_->legs(), moves->moves_in_round);
  if (const auto* wiring = std::get_if<ReportWiring>(&purpose_))
    report_ = nudge_report(wiring->checks(), parts_.calibrator, parts_.drive.robot(), run_->legs());
}

/// After the motion, until its moves are compared and its recording is on the disk.
TaskTurn MotionTask::reported() {
  if (moves_) {
    if (moves_->compare_next(lidar_pose(parts_.applied.get(), parts_.config))) return Running{};
    const double since_1970 = 1e-6 * static_cast<double>(parts_.clock.wall_us()) - parts_.clock.now();
    report_ = moves_->body(parts_.drive.described(), since_1970);
    parts_.write_back.proof.driven(report_);
    moves_.reset();
  }
  return written_.result() ? written(*written_.result()) : TaskTurn(Running{});
}

TaskTurn MotionTask::written(const Result<std::filesystem::path>& path) {
  if (!path) return Failed{path.error()};
  if (const auto* solve = std::get_if<SolveRecording>(&purpose_)) {
    SolvingTask::Order order{solve->earlier, solve->effects};
    order.recordings.push_back(path.value());
    return Then{std::make_unique<SolvingTask>(
        SolvingTask::Parts{parts_.outbox, parts_.calibrator, parts_.config}, caller, order)};
  }
  report_["limited"] = limited_;
  report_["recording"] = path.value().string();
  return done_with({{"result", report_}});
}

}  // namespace odomcalib
