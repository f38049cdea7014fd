#include "daemon/service/tasks/motion_task.hpp"

#include <fmt/format.h>

#include "daemon/service/leg_report.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/tasks/solving_task.hpp"

namespace odomcalib {
Result<std::unique_ptr<Task>> MotionTask::begin(Bench& bench, const Caller& caller, Order order) {
  Outbox& outbox = bench.outbox;
  const auto path = outbox.telemetry.recorder.start(
      fmt::format("{}-{}", order.plan.name, bench.clock.wall_us() / 1'000'000));
  if (!path) return path.error();
  bench.recorded = {};
  outbox.send_robot(bench.drive.described());
  bench.loop.motion_begins();
  bench.last_run.begins(order.plan.name);
  bench.surroundings.braking.begins();
  const std::string name = order.plan.name;
  // Recorded with the motion, and over with it.
  if (!order.unseen.empty())
    outbox.event(messages::Severity::warning, "vouched",
                 fmt::format("{} vouches for this motion, asked for by {}: {}", order.vouched_by,
                             outbox.server.name_of(caller.client), order.unseen));
  std::unique_ptr<Task> task(new MotionTask(bench, caller, std::move(order)));
  outbox.event(messages::Severity::info, "motion",
               name + " begins, for " + outbox.server.name_of(caller.client));
  return task;
}

MotionTask::MotionTask(Bench& bench, const Caller& waits, Order order)
    : Task(waits),
      lease_(std::move(order.lease)),
      purpose_(std::move(order.purpose)),
      limited_(routines::limited(order.plan)),
      speed_(order.plan.limits),
      stepped_at_(bench.now),
      suspended_at_(bench.clock.suspended()) {
  run_.emplace(MotionRun::Options{.plan = std::move(order.plan),
                                  .geometry = bench.drive.geometry(),
                                  .countdown = bench.config.countdown,
                                  .now = bench.now,
                                  .flush = [&bench] { bench.drive.link.flush(); }},
               bench.drive.controller());
}

std::string MotionTask::activity(const Bench& bench) const {
  if (run_) return "moving: " + run_->activity();
  return bench.write_back.busy() ? "reading or writing parameters" : "writing the recording";
}

void MotionTask::stop(Bench& /*bench*/) {
  if (run_) run_->stop({ErrorCode::cancelled, "stopped on request", "motion", "start again"});
}

void MotionTask::abandoned(Bench& /*bench*/) {
  if (run_) run_->stop({ErrorCode::cancelled, "the client closed its connection", "motion", "start again"});
}

void MotionTask::drive_stopped(const std::string& why) {
  if (run_) run_->fault(why);
}

void MotionTask::scanned(const Bench& bench, const Scan& scan) {
  if (!run_) return;
  run_->seen(scan);
  if (run_->driving())
    agreement_.seen(scan, bench.odometry.at(middle_of(scan)), bench.calibrator, bench.config.lidar_pose);
}

TaskTurn MotionTask::daemon_ends(Bench& bench, const Error& why) {
  if (!run_) return Running{};
  run_->stop(why);
  return ended(bench);
}

TaskTurn MotionTask::turn(Bench& bench) {
  if (!run_) return reported(bench);
  if (bench.now < next_step_) return Running{};
  next_step_ = bench.now + service::settings::kControlStep_s;
  watch_loop(bench);
  if (const auto problem = bench.outbox.telemetry.recorder.problem()) run_->stop(*problem);
  // A nudge finds out what the counts are worth: they are held to the limits, not to the command.
  const bool nudge = std::holds_alternative<ReportWiring>(purpose_);
  const routines::Twist commanded =
      nudge ? routines::Twist{routines::kCaps.speed, routines::kCaps.turn_rate} : run_->twist();
  speed_.seen(bench.drive.newest_ticks.t, bench.odometry.pose(), commanded);
  bench.surroundings.braking.seen(bench.drive.newest_ticks.t, bench.odometry.pose(), run_->twist());
  run_->step(situation(bench));
  const auto rates = routines::to_wheels(run_->twist(), bench.drive.geometry());
  bench.drive.encoders.commanded(rates.left, rates.right, bench.now);
  if (run_->ended()) return ended(bench);
  bench.outbox.progress(caller, run_->activity(), run_->fraction(), run_->remaining());
  return Running{};
}

Situation MotionTask::situation(const Bench& bench) const {
  const auto encoders = bench.drive.encoders.stale(bench.now);
  return {.now = bench.now,
          .odometry = bench.odometry.pose(),
          .ticks = bench.drive.newest_ticks,
          .lapsed = lapsed(bench),
          .stale = encoders ? encoders : bench.surroundings.scans.stale(bench.now),
          .disagreement = agreement_.disagreement(),
          .by_lidar = agreement_.motion(),
          .too_fast = speed_.too_fast(),
          .obstacle = bench.surroundings.obstacles.obstacle()};
}

// While the loop is held up, nobody steers. The drive's own watchdog stops it after 200 ms without us (M1);
// so do we, and say what it was. A shorter one is reported. A machine that was suspended is no exception:
// what it woke up to is not what it had seen (M12).
void MotionTask::watch_loop(Bench& bench) {
  const double slept = bench.clock.suspended() - std::exchange(suspended_at_, bench.clock.suspended());
  if (slept > service::settings::kLongestPause_s)
    return run_->stop({ErrorCode::protective_stop,
                       fmt::format("the machine was suspended for {:.1f} s", slept), "daemon",
                       "look where the robot is, then start again by hand"});
  const double pause = bench.now - std::exchange(stepped_at_, bench.now);
  if (pause < service::settings::kNoticedPause_s) return;
  const auto& longest = bench.loop.in_motion();
  const std::string text =
      fmt::format("the daemon was held up for {:.0f} ms (in \"{}\")", 1e3 * pause, longest.part);
  ++bench.late_steps;
  if (pause < service::settings::kLongestPause_s)
    return bench.outbox.event(messages::Severity::warning, "loop_late", text);
  run_->stop({ErrorCode::protective_stop, text, "daemon",
              "see \"loop\" in odomcalibctl status --json; relieve the processor"});
}

// Names both sides: how old the last renewal is, and how long nobody here looked.
std::optional<std::string> MotionTask::lapsed(const Bench& bench) const {
  if (bench.lease.holds(lease_)) return std::nullopt;
  const auto& longest = bench.loop.in_motion();
  return fmt::format(
      "the client stopped or no longer renews its lease: last renewal {:.0f} ms ago (the longest turn of the "
      "daemon's loop in this motion was {:.0f} ms, in \"{}\", {:.1f} s ago)",
      1e3 * bench.lease.age(bench.now), 1e3 * longest.seconds, longest.part, bench.now - longest.at);
}

TaskTurn MotionTask::ended(Bench& bench) {
  const auto error = run_->error();
  if (!error) begin_report(bench);
  run_.reset();
  bench.drive.encoders.commanded(0.0, 0.0, bench.now);
  if (error) {
    bench.outbox.telemetry.recorder.finish({});
    bench.last_run.stopped(error->text());
    bench.outbox.event(messages::Severity::stop, "stopped", error->text());
    return Failed{*error};
  }
  bench.last_run.ends();
  // The disk takes its time; whoever asked gets the answer when the recording is whole.
  written_.finish(bench.outbox.telemetry.recorder);
  bench.outbox.event(messages::Severity::info, "motion", "motion finished");
  return Running{};
}

void MotionTask::begin_report(const Bench& bench) {
  report_ = ordered_json::object();
  if (const auto* moves = std::get_if<ReportMoves>(&purpose_))
    moves_.emplace(bench, run_->legs(), moves->moves_in_round);
  if (std::holds_alternative<ReportWiring>(purpose_)) report_ = nudge_report(bench, run_->legs());
}

/// After the motion, until its moves are compared and its recording is on the disk.
TaskTurn MotionTask::reported(Bench& bench) {
  if (moves_) {
    if (moves_->compare_next(bench)) return Running{};
    report_ = moves_->body(bench);
    bench.write_back.proof.driven(report_);
    moves_.reset();
  }
  return written_.result() ? written(bench, *written_.result()) : TaskTurn(Running{});
}

TaskTurn MotionTask::written(const Bench& bench, const Result<std::filesystem::path>& path) {
  if (!path) return Failed{path.error()};
  if (const auto* solve = std::get_if<SolveRecording>(&purpose_)) {
    SolvingTask::Order order{solve->earlier, solve->effects};
    order.recordings.push_back(path.value());
    return Then{std::make_unique<SolvingTask>(bench, caller, order)};
  }
  report_["limited"] = limited_;
  report_["recording"] = path.value().string();
  return done_with({{"result", report_}});
}

}  // namespace odomcalib
