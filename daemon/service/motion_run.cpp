#include "daemon/service/motion_run.hpp"

#include <algorithm>
#include <array>

#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

Error protective(const std::string& what) {
  return {ErrorCode::protective_stop, what, "motion", "remove the cause, then start again by hand"};
}

}  // namespace

std::string name_of(MotionRun::Phase phase) {
  constexpr std::array kNames = {"countdown", "enabling", "standing", "driving",
                                 "resting",   "done",     "stopped"};
  return kNames.at(static_cast<std::size_t>(phase));
}

MotionRun::MotionRun(Options options, drivers::Controller& controller)
    : options_(std::move(options)),
      controller_(controller),
      runner_(options_.plan),
      preview_(routines::preview(options_.plan)),
      envelope_(safety::Envelope::of(preview_)),
      since_(options_.now),
      now_(options_.now),
      guard_([this] {
        (void)controller_.command(0.0, 0.0, now_);
        controller_.quick_stop(now_);
        controller_.disable(now_);
        if (options_.flush) options_.flush();
      }) {}

void MotionRun::seen(const Scan& scan) {
  scan_ = scan;
  if (now_ - moved_at_ < service::settings::kComeToRest_s) return;
  if (at_rest_.size() == service::settings::kMostAtRest) at_rest_.erase(at_rest_.begin());
  at_rest_.push_back(scan);
}

void MotionRun::enter(Phase phase, double now) {
  phase_ = phase;
  since_ = now;
}

void MotionRun::finish(Phase phase) {
  twist_ = {};
  guard_.stop();
  enter(phase, now_);
}

void MotionRun::stop(const Error& why) {
  if (ended()) return;
  error_ = why;
  finish(Phase::stopped);
}

void MotionRun::fault(const std::string& text) {
  stop({ErrorCode::protective_stop, text, "controller", "see odomcalibctl status, then start again by hand"});
}

// Everything that forbids motion, in the order in which it is reported.
void MotionRun::check(const Situation& situation) {
  if (situation.lapsed) return stop({ErrorCode::cancelled, *situation.lapsed, "motion", "start again"});
  if (situation.stale) return stop(protective(*situation.stale));
  if (situation.too_fast) return stop(protective(*situation.too_fast));
  if (phase_ == Phase::countdown || phase_ == Phase::enabling) return;
  if (controller_.state() != drivers::ControllerState::enabled)
    return stop({ErrorCode::device, "the controller left the enabled state", "controller",
                 "see odomcalibctl status"});
  if (phase_ != Phase::driving) return;
  if (situation.obstacle) return stop(protective(*situation.obstacle));
  if (situation.disagreement) return stop(protective(*situation.disagreement));
  const double elapsed = situation.now - drive_began_;
  for (const auto& from_start : {relative(start_, situation.odometry), situation.by_lidar})
    if (const auto why = envelope_.violated(from_start, from_start.yaw, elapsed))
      return stop(protective(*why));
}

void MotionRun::command(const routines::Twist& twist, double now) {
  const auto rates = routines::to_wheels(twist, options_.geometry);
  if (const auto taken = controller_.command(rates.left, rates.right, now); !taken)
    stop({ErrorCode::device, taken.error().what, "controller", taken.error().remedy});
}

void MotionRun::note_legs(const routines::RunState& before, const Situation& situation) {
  const auto& after = runner_.state();
  const bool begins = after.phase == routines::Phase::moving &&
                      (before.phase == routines::Phase::beginning || before.move != after.move);
  if (begins) {
    Leg leg;
    leg.move = options_.plan.moves[after.move];
    leg.begin = situation.now;
    leg.before = situation.odometry;
    leg.ticks_before = situation.ticks;
    leg.scan_before = scan_;
    leg.scans_before = at_rest_;
    legs_.push_back(std::move(leg));
  }
  const bool ends = before.phase == routines::Phase::settling && after.phase != routines::Phase::settling;
  if (ends && !legs_.empty()) {
    legs_.back().end = situation.now;
    legs_.back().after = situation.odometry;
    legs_.back().ticks_after = situation.ticks;
    legs_.back().scan_after = scan_;
    legs_.back().scans_after = at_rest_;
  }
}

// The plan was previewed and its way checked from the origin (M10): it is driven in the frame of its start,
// wherever the odometry happens to be.
void MotionRun::drive(const Situation& situation) {
  const routines::RunState before = runner_.state();
  twist_ = runner_.step(situation.now, relative(start_, situation.odometry));
  note_legs(before, situation);
  command(twist_, situation.now);
  if (twist_.v != 0.0 || twist_.w != 0.0) {
    moved_at_ = situation.now;
    at_rest_.clear();
  }
  if (runner_.done() && !ended()) enter(Phase::resting, situation.now);
}

void MotionRun::advance(const Situation& situation) {
  const double elapsed = situation.now - since_;
  switch (phase_) {
    case Phase::countdown:
      if (elapsed < options_.countdown) return;
      controller_.enable(situation.now);
      return enter(Phase::enabling, situation.now);
    case Phase::enabling:
      if (controller_.state() == drivers::ControllerState::enabled)
        return enter(Phase::standing, situation.now);
      if (elapsed > service::settings::kEnableTimeout_s)
        stop({ErrorCode::device, "the axes were not enabled within 3 s", "controller",
              "see odomcalibctl status"});
      return;
    case Phase::standing:
      command({}, situation.now);
      if (elapsed < service::settings::kStanding_s || ended()) return;
      start_ = situation.odometry;
      drive_began_ = situation.now;
      return enter(Phase::driving, situation.now);
    case Phase::driving:
      return drive(situation);
    case Phase::resting:
      command({}, situation.now);
      if (elapsed >= service::settings::kStanding_s && !ended()) finish(Phase::done);
      return;
    case Phase::done:
    case Phase::stopped:
      return;
  }
}

void MotionRun::step(const Situation& situation) {
  if (ended()) return;
  now_ = situation.now;
  check(situation);
  if (!ended()) advance(situation);
}

std::string MotionRun::activity() const {
  const bool on_move = phase_ == Phase::driving && runner_.state().move < options_.plan.moves.size();
  return on_move ? options_.plan.moves[runner_.state().move].name : name_of(phase_);
}

double MotionRun::remaining() const {
  if (phase_ < Phase::driving) return preview_.duration;
  return phase_ == Phase::driving ? std::max(0.0, preview_.duration - (now_ - drive_began_)) : 0.0;
}

double MotionRun::fraction() const {
  return preview_.duration > 0.0 ? 1.0 - remaining() / preview_.duration : 1.0;
}

}  // namespace odomcalib
