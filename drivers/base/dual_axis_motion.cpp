// Process data of the two axes: counts, status, and the cyclic command with its time-outs.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/dual_axis.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {
namespace {

using canopen::DriveState;

constexpr double kCycle_s = 0.02;
constexpr double kIdleCycle_s = 0.05;  // zero commands that keep a vendor's time-out from firing
constexpr double kCommandLives_s = 0.1;
constexpr double kPositionsLive_s = 0.1;
constexpr double kStep_s = 1.0;  // longest wait for the next drive state
constexpr double kRest_s = 0.1;
constexpr double kEnding_s = 3.0;     // longest ramp to standstill before torque is taken away anyway
constexpr unsigned kResetCycles = 4;  // half a period of the fault reset's edge
constexpr std::size_t kMostQueued = 4096;
constexpr std::uint8_t kMostSyncs = 240;  // transmission types 1..240: every n-th SYNC
constexpr std::uint8_t kOnEvent = 254;    // 254, 255: on change or timer
constexpr double kSyncLives_s = 0.05;     // a frame later than that belongs to no SYNC we know of

/// Bits of a standard frame without stuffing, with its inter-frame space.
double frame_time(const CanFrame& frame, unsigned bitrate) { return (47.0 + 8.0 * frame.length) / bitrate; }

double rpm(double rad_s) { return rad_s * 30.0 / std::numbers::pi; }

}  // namespace

bool DualAxis::both_axes(DriveState state) const { return axes_[0] == state && axes_[1] == state; }
bool DualAxis::any_axis(DriveState state) const { return axes_[0] == state || axes_[1] == state; }
bool DualAxis::at_rest() const { return now_ - moved_at_ >= kRest_s; }

void DualAxis::on_process_data(const canopen::Pdo& pdo, const CanFrame& frame) {
  if (frame.length < canopen::mapped_bytes(pdo)) {
    ++short_pdos_;
    return;
  }
  ++frames_used_;
  const auto left = canopen::unpack(pdo, frame, profile_.position_left);
  const auto right = profile_.axes == 1 ? std::optional<std::uint64_t>(0)
                                        : canopen::unpack(pdo, frame, profile_.position_right);
  if (left && right)
    on_positions(static_cast<std::int32_t>(sign_extend(*left, 32)),
                 static_cast<std::int32_t>(sign_extend(*right, 32)), sampled_at(pdo, frame));
  if (profile_.fault) {
    if (const auto fault = canopen::unpack(pdo, frame, *profile_.fault))
      fault_code_ = static_cast<std::uint32_t>(*fault);
  }
  if (const auto status = canopen::unpack(pdo, frame, profile_.status))
    on_status(static_cast<std::uint32_t>(*status));
}

/// Data on SYNC were sampled at its end, others when the frame began; those on the drive's timer keep its
/// beat.
double DualAxis::sampled_at(const canopen::Pdo& pdo, const CanFrame& frame) {
  const bool on_sync = pdo.type >= 1 && pdo.type <= kMostSyncs;
  if (on_sync && sync_at_ && frame.t - *sync_at_ < kSyncLives_s) return *sync_at_;
  const double began = frame.t - frame_time(frame, profile_.bitrate);
  const unsigned timer = pdo.type >= kOnEvent ? pdo.event_timer.value_or(0) : 0;
  if (timer == 0) return began;
  if (!timer_) timer_.emplace(1e-3 * profile_.heartbeat_unit_ms * timer);
  return timer_->date(began);
}

void DualAxis::on_positions(std::int32_t left, std::int32_t right, double t) {
  if (phase_ != Phase::ready && phase_ != Phase::starting) return;  // before that the mapping is not ours
  const TickUnwrap::Reading l = left_.unwrap.on_count(left, t);
  const TickUnwrap::Reading r = right_.unwrap.on_count(right, t);
  positions_at_ = now_;
  if (l.jumped || r.jumped) {
    ++jumps_;
    ++segment_;
    event("tick_jump",
          std::string(l.jumped ? "left" : "right") + " count jumped: reset, or a broken encoder line",
          motion_ != Motion::off);
  }
  const auto follow = [&](Wheel& wheel, std::int64_t total, int sign) {
    wheel.watch.counted(sign * total, t, now_);
    if (wheel.total != total) moved_at_ = now_;
    wheel.total = total;
  };
  follow(left_, l.total, profile_.left_sign);
  follow(right_, r.total, profile_.right_sign);
  if (ticks_.size() >= kMostQueued) {
    ++dropped_;
    return;
  }
  ticks_.push_back({t, profile_.left_sign * l.total, profile_.right_sign * r.total, segment_});
}

void DualAxis::on_status(std::uint32_t status) {
  if (phase_ != Phase::ready && phase_ != Phase::starting) return;
  status_at_ = now_;
  const std::array<DriveState, 2> before = axes_;
  status_ = status;
  axes_ = {canopen::decode_status(static_cast<std::uint16_t>(status)),
           canopen::decode_status(static_cast<std::uint16_t>(status >> 16))};
  if (profile_.axes == 1) axes_[1] = axes_[0];
  if (axes_ != before) motion_since_ = now_;
  if (motion_ != Motion::on || both_axes(DriveState::enabled)) return;
  const DriveState odd = axes_[0] == DriveState::enabled ? axes_[1] : axes_[0];
  const bool fault = any_axis(DriveState::fault) || any_axis(DriveState::fault_reaction);
  event(fault ? "drive_fault" : "axis_not_enabled",
        std::string(axes_[0] == DriveState::enabled ? "right" : "left") + " axis fell to \"" +
            canopen::to_text(odd) + "\", error code " + std::to_string(fault_code_),
        true);
}

std::int64_t DualAxis::speed_counts(double rad_s, int sign) const {
  const double limited = std::clamp(rpm(rad_s), -profile_.max_rpm, profile_.max_rpm);
  return sign * static_cast<std::int64_t>(std::lround(limited / profile_.rpm_per_count));
}

void DualAxis::send_command(std::uint16_t control_word, double left_rad_s, double right_rad_s) {
  const auto left = static_cast<std::uint64_t>(speed_counts(left_rad_s, profile_.left_sign));
  const auto right = static_cast<std::uint64_t>(speed_counts(right_rad_s, profile_.right_sign));
  std::vector<CanFrame> frames;
  for (const canopen::Pdo& pdo : profile_.pdos) {
    if (pdo.transmit) continue;
    CanFrame frame;
    frame.id = pdo.cob_id;
    frame.length = static_cast<std::uint8_t>(canopen::mapped_bytes(pdo));
    pack(pdo, frame, profile_.control, control_word);
    pack(pdo, frame, profile_.speed_left, left);
    if (profile_.axes == 2) pack(pdo, frame, profile_.speed_right, right);
    frames.push_back(frame);
  }
  // The last target may still be in the object: targets go first, the control word last.
  out_.insert(out_.end(), frames.rbegin(), frames.rend());
  cycle_due_ = now_ + kCycle_s;
}

void DualAxis::enable(double now) {
  now_ = std::max(now_, now);
  if (phase_ != Phase::ready) return event("enable_refused", "the controller is not configured", false);
  if (!watchdog_armed_)
    return event("enable_refused", "the controller would not stop by itself if this program died", false);
  if (job_.running()) return event("enable_refused", "a parameter job is in progress", false);
  if (motion_ == Motion::on || motion_ == Motion::enabling) return;
  motion_ = Motion::enabling;
  motion_since_ = now_;
  cycles_ = 0;
  step_enabling();
}

void DualAxis::disable(double now) {
  now_ = std::max(now_, now);
  if (motion_ == Motion::on || motion_ == Motion::enabling) end_motion(Motion::disabling);
}

void DualAxis::end_motion(Motion how) {
  motion_ = how;
  motion_since_ = now_;
  command_left_ = command_right_ = 0.0;
  moved_at_ = now_;  // rest is to be seen from now on
  send_command(how == Motion::stopping ? canopen::kQuickStop : canopen::kEnableOperation, 0.0, 0.0);
}

void DualAxis::quick_stop(double now) {
  now_ = std::max(now_, now);
  const bool known = identity_ && phase_ != Phase::foreign;
  if (!known) return;
  if (motion_ == Motion::stopping) return send_command(canopen::kQuickStop, 0.0, 0.0);
  end_motion(Motion::stopping);
}

Result<void> DualAxis::command(double left_rad_s, double right_rad_s, double now) {
  now_ = std::max(now_, now);
  const std::string where = "controller " + profile_.name;
  if (!std::isfinite(left_rad_s) || !std::isfinite(right_rad_s)) {
    event("bad_command", "a speed command was not a number", true);
    return Error{ErrorCode::refused, "speed is not a finite number", where, ""};
  }
  if (motion_ != Motion::on || phase_ != Phase::ready)
    return Error{ErrorCode::refused, "axes are not enabled", where, "enable first"};
  const double most = profile_.max_rpm * std::numbers::pi / 30.0;
  if (std::max(std::abs(left_rad_s), std::abs(right_rad_s)) > most) ++limited_commands_;
  command_left_ = std::clamp(left_rad_s, -most, most);
  command_right_ = std::clamp(right_rad_s, -most, most);
  command_at_ = now_;
  return {};
}

void DualAxis::cycle_motion() {
  if (phase_ != Phase::ready) return;
  check_motion();
  if (now_ < cycle_due_) return;
  switch (motion_) {
    case Motion::off:
      // A late word may have enabled an axis after the motion had ended. With another master it may be his.
      if (profile_.watchdog.kind == ProfileWatchdog::Kind::object ||
          (other_master_ == 0 && any_axis(DriveState::enabled))) {
        send_command(canopen::kDisableVoltage, 0.0, 0.0);
        cycle_due_ = now_ + kIdleCycle_s;
      }
      return;
    case Motion::enabling:
      return step_enabling();
    case Motion::disabling:
    case Motion::stopping:
      return step_ending();
    case Motion::on:
      break;
  }
  const bool fresh = now_ - command_at_ <= kCommandLives_s;
  if (!fresh && (command_left_ != 0.0 || command_right_ != 0.0)) {
    ++stale_commands_;
    command_left_ = command_right_ = 0.0;
  }
  send_command(canopen::kEnableOperation, command_left_, command_right_);
}

void DualAxis::step_enabling() {
  if (both_axes(DriveState::enabled)) {
    motion_ = Motion::on;
    command_left_ = command_right_ = 0.0;
    command_at_ = now_;
    left_.watch.begin(now_);
    right_.watch.begin(now_);
  } else if (now_ - motion_since_ > kStep_s) {
    const std::string states = canopen::to_text(axes_[0]) + ", " + canopen::to_text(axes_[1]);
    event("enable_failed",
          "the axes do not get beyond \"" + states + "\", error code " + std::to_string(fault_code_), false);
    motion_ = Motion::off;
    return send_command(canopen::kDisableVoltage, 0.0, 0.0);
  }
  const bool edge = (cycles_++ / kResetCycles) % 2 == 1;
  send_command(canopen::control_word_towards_enabled(axes_[0], axes_[1], edge), 0.0, 0.0);
}

/// Speed zero until the wheels stand, then the torque goes. A quick stop is repeated until the drive shows
/// it.
void DualAxis::step_ending() {
  const bool stopping = motion_ == Motion::stopping;
  const bool without_torque = !any_axis(DriveState::enabled) && !any_axis(DriveState::quick_stop_active);
  const bool may_end = (stopping ? !any_axis(DriveState::enabled) : true) && at_rest();
  if (without_torque || may_end || now_ - motion_since_ > kEnding_s) {
    const bool shown = !any_axis(DriveState::enabled);
    send_command(canopen::kDisableVoltage, 0.0, 0.0);
    if (shown) motion_ = Motion::off;
    return;
  }
  send_command(stopping ? canopen::kQuickStop : canopen::kEnableOperation, 0.0, 0.0);
}

void DualAxis::check_motion() {
  if (motion_ != Motion::on && motion_ != Motion::enabling) return;
  const double oldest =
      std::min(positions_at_.value_or(-1e9), motion_ == Motion::on ? status_at_.value_or(-1e9) : now_);
  if (now_ - oldest > kPositionsLive_s)
    return event("pdo_frozen", "no process data of the controller for more than 100 ms", true);
  if (motion_ == Motion::on) check_encoders();
}

void DualAxis::check_encoders() {
  left_.watch.commanded(command_left_, now_);
  right_.watch.commanded(command_right_, now_);
  const bool left = left_.watch.stuck(now_);
  const bool right = right_.watch.stuck(now_);
  if (left || right)
    event("encoder_stuck",
          std::string(left ? "left" : "right") + " count stands still although the wheel is commanded", true);
}

}  // namespace odomcalib::drivers
