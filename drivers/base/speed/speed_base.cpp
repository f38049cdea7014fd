#include "drivers/base/speed/speed_base.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::drivers {
namespace {

constexpr double kGreet_s = 0.3;
constexpr double kCycle_s = 0.02;
constexpr double kCommandLives_s = 0.1;
constexpr double kStep_s = 1.0;  // longest wait until the device says it is enabled
constexpr double kRest_s = 0.15;
constexpr double kEnding_s = 3.0;  // longest ramp to standstill before torque is taken away anyway
constexpr std::size_t kMostQueued = 4096;

std::size_t index(Side side) { return static_cast<std::size_t>(side); }
double ticks_per_s(const Profile& profile) { return profile.max_rpm / 60.0 * profile.ticks_per_rev; }
const char* name_of(Side side) { return side == Side::left ? "left" : "right"; }

}  // namespace

SpeedBase::Wheel SpeedBase::wheel_of(const Profile& profile) {
  return {TickUnwrap(ticks_per_s(profile), profile.count_bits), StuckWatch(profile.ticks_per_rev), {}};
}

SpeedBase::SpeedBase(Profile profile, std::unique_ptr<SpeedProtocol> protocol)
    : profile_(std::move(profile)),
      protocol_(std::move(protocol)),
      wheels_{wheel_of(profile_), wheel_of(profile_)} {}

/// A stop event also stops the wheels right here: the daemon's protective stop is the second line.
void SpeedBase::event(const std::string& code, const std::string& text, bool stop) {
  if (stop && (motion_ == Motion::on || motion_ == Motion::enabling)) quick_stop(now_);
  if (events_.size() >= kMostQueued) {
    ++dropped_;
    return;
  }
  events_.push_back({now_, code, text, stop});
}

void SpeedBase::on_frame(const CanFrame& frame) {
  now_ = std::max(now_, frame.t);
  if (frame.error && (frame.id & 0x040u) != 0)
    return event("bus_off", "the CAN interface is off the bus; restart it", true);
  if (frame.error) return;
  protocol_->on_frame(frame);
  take_news();
}

void SpeedBase::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  now_ = std::max(now_, now);
  protocol_->on_bytes(bytes, now_);
  take_news();
}

void SpeedBase::take_news() {
  (void)protocol_->take_messages();  // for decode
  for (const SideCount& count : protocol_->take_counts()) on_count(count);
}

void SpeedBase::on_count(const SideCount& count) {
  Wheel& wheel = wheels_[index(count.side)];
  const TickUnwrap::Reading reading = wheel.unwrap.on_count(count.raw, count.t);
  counted_at_[index(count.side)] = now_;
  if (reading.jumped) on_jump(count.side);
  const int sign = count.side == Side::left ? profile_.left_sign : profile_.right_sign;
  wheel.watch.counted(sign * reading.total, count.t, now_);
  if (reading.total != wheel.total) moved_at_ = now_;
  wheel.total = reading.total;
  const auto pair = pairing_.add(count.side, count.t, reading.total);
  if (!pair) return;
  if (ticks_.size() >= kMostQueued) {
    ++dropped_;
    return;
  }
  ticks_.push_back({pair->t, profile_.left_sign * pair->left, profile_.right_sign * pair->right, segment_});
}

void SpeedBase::on_jump(Side side) {
  ++jumps_;
  ++segment_;
  pairing_.forget();
  event("tick_jump", std::string(name_of(side)) + " count jumped: reset, or a broken encoder line",
        motion_ != Motion::off);
}

void SpeedBase::on_time(double now) {
  now_ = std::max(now_, now);
  check_presence();
  protocol_->ask(now_);
  if (!present_ && now_ >= greet_due_) {
    protocol_->greet(now_);
    greet_due_ = now_ + kGreet_s;
  }
  check_device();
  if (motion_ == Motion::on) check_encoders();
  if (now_ >= cycle_due_) cycle();
}

void SpeedBase::check_presence() {
  const double oldest = std::min(counted_at_[0], counted_at_[1]);
  if (!present_) {
    present_ = now_ - oldest < profile_.counts_live_s;
    return;
  }
  if (now_ - oldest <= profile_.counts_live_s) return;
  event("counts_lost",
        "no counts of the controller for more than " +
            std::to_string(std::lround(1e3 * profile_.counts_live_s)) + " ms",
        true);
  present_ = false;
  motion_ = Motion::off;
  pairing_.forget();
  for (Wheel& wheel : wheels_) wheel.unwrap.forget();
  ++segment_;
}

void SpeedBase::check_device() {
  const DeviceState said = protocol_->device_state();
  if (!said.fault.empty() && said.fault != last_fault_) event("drive_fault", said.fault, true);
  last_fault_ = said.fault;
  if (motion_ == Motion::on && said.enabled && !*said.enabled)
    event("axis_not_enabled", "the controller no longer follows commands", true);
}

void SpeedBase::check_encoders() {
  for (const Side side : {Side::left, Side::right}) {
    StuckWatch& watch = wheels_[index(side)].watch;
    watch.commanded(command_[index(side)], now_);
    if (!watch.stuck(now_)) continue;
    return event("encoder_stuck",
                 std::string(name_of(side)) + " count stands still although the wheel is commanded", true);
  }
}

bool SpeedBase::at_rest() const { return now_ - moved_at_ >= kRest_s; }

void SpeedBase::cycle() {
  cycle_due_ = now_ + kCycle_s;
  switch (motion_) {
    case Motion::off:
      return;
    case Motion::enabling:
      return step_enabling();
    case Motion::disabling:
    case Motion::stopping:
      return step_ending();
    case Motion::on:
      break;
  }
  if (now_ - command_at_ > kCommandLives_s && (command_[0] != 0.0 || command_[1] != 0.0)) {
    ++stale_commands_;
    command_ = {};
  }
  protocol_->command(profile_.left_sign * command_[0], profile_.right_sign * command_[1]);
}

void SpeedBase::step_enabling() {
  if (protocol_->device_state().enabled.value_or(true)) {
    motion_ = Motion::on;
    command_ = {};
    command_at_ = now_;
    for (Wheel& wheel : wheels_) wheel.watch.begin(now_);
    return protocol_->command(0.0, 0.0);
  }
  if (now_ - motion_since_ <= kStep_s) return protocol_->engage();
  motion_ = Motion::off;
  protocol_->release();
  event("enable_failed",
        "the controller does not say that it follows commands: is a remote control or an "
        "emergency stop active?",
        false);
}

/// Speed zero until the wheels stand, then the torque goes.
void SpeedBase::step_ending() {
  if (!at_rest() && now_ - motion_since_ <= kEnding_s)
    return motion_ == Motion::stopping ? protocol_->stop() : protocol_->command(0.0, 0.0);
  motion_ = Motion::off;
  protocol_->release();
}

void SpeedBase::end_motion(Motion how) {
  motion_ = how;
  motion_since_ = moved_at_ = now_;  // rest is to be seen from now on
  command_ = {};
  if (how == Motion::stopping) return protocol_->stop();
  protocol_->command(0.0, 0.0);
}

void SpeedBase::enable(double now) {
  now_ = std::max(now_, now);
  if (!present_) return event("enable_refused", "the controller is not configured", false);
  if (!watchdog_armed())
    return event("enable_refused", "the controller would not stop by itself if this program died", false);
  if (!last_fault_.empty()) return event("enable_refused", last_fault_, false);
  if (motion_ == Motion::on || motion_ == Motion::enabling) return;
  motion_ = Motion::enabling;
  motion_since_ = now_;
  protocol_->engage();
}

void SpeedBase::disable(double now) {
  now_ = std::max(now_, now);
  if (motion_ == Motion::on || motion_ == Motion::enabling) end_motion(Motion::disabling);
}

void SpeedBase::quick_stop(double now) {
  now_ = std::max(now_, now);
  if (motion_ == Motion::stopping) return protocol_->stop();
  end_motion(Motion::stopping);
}

Result<void> SpeedBase::command(double left_rad_s, double right_rad_s, double now) {
  now_ = std::max(now_, now);
  if (!std::isfinite(left_rad_s) || !std::isfinite(right_rad_s)) {
    event("bad_command", "a speed command was not a number", true);
    return refused("speed is not a finite number", "");
  }
  if (motion_ != Motion::on) return refused("axes are not enabled", "enable first");
  const double most = profile_.max_rpm * std::numbers::pi / 30.0;
  if (std::max(std::abs(left_rad_s), std::abs(right_rad_s)) > most) ++limited_commands_;
  command_ = {std::clamp(left_rad_s, -most, most), std::clamp(right_rad_s, -most, most)};
  command_at_ = now_;
  return {};
}

/// A time-out that the device itself told goes before the one that the profile promises.
bool SpeedBase::watchdog_armed() const {
  const double promised =
      profile_.watchdog.kind == ProfileWatchdog::Kind::builtin ? 1e-3 * profile_.watchdog.time_ms : 0.0;
  const double timeout = protocol_->reported_timeout_s().value_or(promised);
  return present_ && timeout > 0.0 && timeout <= kLongestWatchdog_s;
}

ControllerState SpeedBase::state() const {
  if (!present_) return ControllerState::absent;
  if (motion_ == Motion::enabling) return ControllerState::enabling;
  if (motion_ != Motion::off) return ControllerState::enabled;
  return last_fault_.empty() ? ControllerState::disabled : ControllerState::fault;
}

Error SpeedBase::refused(const std::string& what, const std::string& remedy) const {
  return {ErrorCode::refused, what, "controller " + profile_.name, remedy};
}

Result<void> SpeedBase::start_read_parameters(double now) {
  now_ = std::max(now_, now);
  if (!present_) return refused("controller does not answer", "wait until it does");
  job_result_ = ParameterJobResult{ParameterJobResult::Kind::read, std::nullopt, {}};
  return {};
}

Result<void> SpeedBase::start_write_parameters(const std::vector<ParameterValue>& /*values*/,
                                               double /*now*/) {
  return refused("the controller stores no wheel geometry", "the calibration is kept on the host");
}

Result<void> SpeedBase::start_store(double /*now*/) {
  return refused("the controller stores no wheel geometry", "the calibration is kept on the host");
}

std::vector<Capability> SpeedBase::capabilities() const { return host_capabilities(); }

Counters SpeedBase::counters() const {
  Counters all = protocol_->counters();
  all.insert({{"tick_jumps", jumps_},
              {"unpaired_counts", pairing_.unpaired()},
              {"stale_commands", stale_commands_},
              {"limited_commands", limited_commands_},
              {"events_dropped", dropped_}});
  return all;
}

}  // namespace odomcalib::drivers
