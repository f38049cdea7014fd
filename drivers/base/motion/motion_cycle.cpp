#include "drivers/base/motion/motion_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {

using namespace motion;

MotionCycle::MotionCycle(MotionDevice& device, Options options)
    : device_(device),
      options_(std::move(options)),
      wheels_{Wheel(options_.ticks_per_rev), Wheel(options_.ticks_per_rev)} {}

void MotionCycle::event(const std::string& code, const std::string& text, bool stop, double now) {
  if (stop && active()) quick_stop(now);
  if (events_.size() >= kMostQueued) {
    ++dropped_;
    return;
  }
  events_.push_back({now, code, text, stop});
}

void MotionCycle::enable(double now) {
  if (const std::string refusal = device_.enable_refusal(); !refusal.empty())
    return event("enable_refused", refusal, false, now);
  if (active()) return;
  // The device's view of its axes may be older than the stop: they would seem to follow already.
  if (motion_ != Motion::off) {
    again_ = true;
    return;
  }
  begin_enabling(now);
  step_enabling(now);
}

void MotionCycle::begin_enabling(double now) {
  motion_ = Motion::enabling;
  since_ = now;
  device_.begin_enabling();
}

void MotionCycle::disable(double now) {
  if (!std::exchange(again_, false) && active()) end(Motion::disabling, now);
}

void MotionCycle::quick_stop(double now) {
  again_ = false;
  if (motion_ == Motion::stopping) return device_.stop();
  end(Motion::stopping, now);
}

void MotionCycle::end(Motion how, double now) {
  motion_ = how;
  since_ = moved_at_ = now;  // rest is to be seen from now on
  command_ = {};
  if (how == Motion::stopping) return device_.stop();
  device_.drive(0.0, 0.0);
}

Result<void> MotionCycle::command(double left_rad_s, double right_rad_s, double now) {
  const auto refused = [&](const std::string& what, const std::string& remedy) {
    return Error{ErrorCode::refused, what, "controller " + options_.name, remedy};
  };
  if (!std::isfinite(left_rad_s) || !std::isfinite(right_rad_s)) {
    event("bad_command", "a speed command was not a number", true, now);
    return refused("speed is not a finite number", "");
  }
  if (motion_ != Motion::on) return refused("axes are not enabled", "enable first");
  const double most = options_.max_rad_s;
  if (std::max(std::abs(left_rad_s), std::abs(right_rad_s)) > most) ++limited_commands_;
  command_ = {std::clamp(left_rad_s, -most, most), std::clamp(right_rad_s, -most, most)};
  command_at_ = now;
  return {};
}

void MotionCycle::counted(Side side, std::int64_t forward, double t, double now) {
  Wheel& wheel = wheels_[static_cast<std::size_t>(side)];
  wheel.watch.counted(forward, t, now);
  if (wheel.forward != forward) moved_at_ = now;
  wheel.forward = forward;
}

void MotionCycle::check_encoders(double now) {
  std::array<bool, 2> stuck{};
  for (std::size_t side = 0; side < wheels_.size(); ++side) {
    wheels_[side].watch.commanded(command_[side], now);
    stuck[side] = wheels_[side].watch.stuck(now);
  }
  if (!stuck[0] && !stuck[1]) return;
  event("encoder_stuck",
        std::string(stuck[0] ? "left" : "right") + " count stands still although the wheel is commanded",
        true, now);
}

void MotionCycle::defer(double now) { due_ = now + kCycle_s; }

void MotionCycle::cycle(double now) {
  if (now < due_) return;
  defer(now);
  switch (motion_) {
    case Motion::off:
      due_ = now + device_.idle();
      return;
    case Motion::enabling:
      return step_enabling(now);
    case Motion::on:
      return step_on(now);
    case Motion::disabling:
    case Motion::stopping:
      return step_ending(now);
  }
}

void MotionCycle::step_on(double now) {
  if (now - command_at_ > kCommandLives_s && (command_[0] != 0.0 || command_[1] != 0.0)) {
    ++stale_commands_;
    command_ = {};
  }
  device_.drive(command_[0], command_[1]);
}

void MotionCycle::step_enabling(double now) {
  if (device_.follows()) {
    motion_ = Motion::on;
    command_ = {};
    command_at_ = now;
    for (Wheel& wheel : wheels_) wheel.watch.begin(now);
    return device_.drive(0.0, 0.0);
  }
  if (now - since_ <= kStep_s) return device_.engage();
  motion_ = Motion::off;
  device_.release();
  event("enable_failed", device_.enable_failure(), false, now);
}

/// Speed zero until the wheels stand, then the torque goes. A quick stop is repeated until the device shows
/// it, and the torque is taken away until the device shows that it is gone.
void MotionCycle::step_ending(double now) {
  const bool stopping = motion_ == Motion::stopping;
  const bool torque = device_.shows_torque();
  const bool stands = at_rest(now) && !(stopping && torque);
  if (!device_.shows_no_torque() && !stands && now - since_ <= kEnding_s)
    return stopping ? device_.stop() : device_.drive(0.0, 0.0);
  device_.release();
  if (torque) return;
  motion_ = Motion::off;
  if (std::exchange(again_, false)) begin_enabling(now);
}

void MotionCycle::count_into(Counters& counters) const {
  counters["stale_commands"] = stale_commands_;
  counters["limited_commands"] = limited_commands_;
  counters["events_dropped"] += dropped_;
}

}  // namespace odomcalib::drivers
