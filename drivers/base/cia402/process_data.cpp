#include "drivers/base/cia402/process_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/base/cia402/settings.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {
namespace {

using namespace cia402;
using canopen::DriveState;

double rpm(double rad_s) { return rad_s * 30.0 / std::numbers::pi; }

}  // namespace

ProcessData::ProcessData(const Profile& profile, std::vector<CanFrame>& out)
    : profile_(profile),
      out_(out),
      motion_(*this,
              {profile.name, profile.max_rpm * std::numbers::pi / 30.0, profile.ticks_per_rev, kRest_s}),
      dates_(profile),
      counts_(profile) {}

void ProcessData::event(const std::string& code, const std::string& text, bool stop, double now) {
  now_ = now;
  motion_.event(code, text, stop, now_);
}

bool ProcessData::both_axes(DriveState state) const { return axes_[0] == state && axes_[1] == state; }
bool ProcessData::any_axis(DriveState state) const { return axes_[0] == state || axes_[1] == state; }

void ProcessData::on_frame(const canopen::Pdo& pdo, const CanFrame& frame, bool expected, double now) {
  now_ = now;
  if (frame.length < canopen::mapped_bytes(pdo)) {
    ++short_pdos_;
    return;
  }
  ++used_;
  const auto left = canopen::unpack(pdo, frame, profile_.position_left);
  const auto right = profile_.axes == 1 ? std::optional<std::uint64_t>(0)
                                        : canopen::unpack(pdo, frame, profile_.position_right);
  if (left && right) {
    const double t = dates_.date(pdo, frame);
    if (expected)
      on_positions(static_cast<std::int32_t>(sign_extend(*left, 32)),
                   static_cast<std::int32_t>(sign_extend(*right, 32)), t);
  }
  if (profile_.fault) {
    if (const auto fault = canopen::unpack(pdo, frame, *profile_.fault))
      fault_code_ = static_cast<std::uint32_t>(*fault);
  }
  if (!expected) return;
  if (const auto status = canopen::unpack(pdo, frame, profile_.status))
    on_status(static_cast<std::uint32_t>(*status));
}

void ProcessData::on_positions(std::int32_t left, std::int32_t right, double t) {
  positions_at_ = now_;
  const bool left_ok = on_count(Side::left, left, t);
  const bool right_ok = on_count(Side::right, right, t);
  if (left_ok && right_ok) return;
  event("tick_jump",
        std::string(to_text(left_ok ? Side::right : Side::left)) +
            " count jumped: reset, or a broken encoder line",
        motion_.motion() != Motion::off, now_);
}

/// False when no wheel turns so fast.
bool ProcessData::on_count(Side side, std::int32_t count, double t) {
  const WheelCounts::Reading reading = counts_.on_count(side, count, t);
  if (reading.kind == TickUnwrap::Reading::Kind::wild) {
    motion_.moved(now_);
    return false;
  }
  motion_.counted(side, reading.forward, t, now_);
  return true;
}

void ProcessData::on_status(std::uint32_t status) {
  status_at_ = now_;
  const std::array<DriveState, 2> before = axes_;
  axes_ = {canopen::decode_status(static_cast<std::uint16_t>(status)),
           canopen::decode_status(static_cast<std::uint16_t>(status >> 16))};
  if (profile_.axes == 1) axes_[1] = axes_[0];
  if (axes_ != before) motion_.progressed(now_);
  if (motion_.motion() != Motion::on || both_axes(DriveState::enabled)) return;
  const DriveState odd = axes_[0] == DriveState::enabled ? axes_[1] : axes_[0];
  const bool fault = any_axis(DriveState::fault) || any_axis(DriveState::fault_reaction);
  event(fault ? "drive_fault" : "axis_not_enabled",
        std::string(axes_[0] == DriveState::enabled ? "right" : "left") + " axis fell to \"" +
            canopen::to_text(odd) + "\", error code " + std::to_string(fault_code_),
        true, now_);
}

std::int64_t ProcessData::speed_counts(double rad_s, int sign) const {
  const double limited = std::clamp(rpm(rad_s), -profile_.max_rpm, profile_.max_rpm);
  return sign * static_cast<std::int64_t>(std::lround(limited / profile_.rpm_per_count));
}

void ProcessData::send_command(std::uint16_t control_word, double left_rad_s, double right_rad_s) {
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
  motion_.defer(now_);
}

void ProcessData::enable(const std::string& refusal, double now) {
  now_ = now;
  refusal_ = refusal;
  motion_.enable(now_);
}

void ProcessData::disable(double now) {
  now_ = now;
  motion_.disable(now_);
}

void ProcessData::quick_stop(double now) {
  now_ = now;
  motion_.quick_stop(now_);
}

Result<void> ProcessData::command(double left_rad_s, double right_rad_s, double now) {
  now_ = now;
  return motion_.command(left_rad_s, right_rad_s, now_);
}

void ProcessData::cycle(bool commanded, double now) {
  now_ = now;
  commanded_ = commanded;
  check_motion();
  motion_.cycle(now_);
}

void ProcessData::sync(double now) {
  if (now < sync_due_) return;
  const bool in_time = now - sync_due_ < profile_.sync_period_s;
  sync_due_ = (in_time ? sync_due_ : now) + profile_.sync_period_s;
  CanFrame frame;
  frame.id = 0x080;
  out_.push_back(frame);
  on_sync(now);
}

void ProcessData::expect() {
  positions_at_.reset();
  status_at_.reset();
}

void ProcessData::forget() {
  motion_.forget();
  expect();
  dates_.forget();
  counts_.begin_segment();
}

void ProcessData::check_motion() {
  if (!motion_.active()) return;
  const bool on = motion_.motion() == Motion::on;
  const double oldest = std::min(positions_at_.value_or(-1e9), on ? status_at_.value_or(-1e9) : now_);
  if (now_ - oldest > kPositionsLive_s)
    return event("pdo_frozen", "no process data of the controller for more than 100 ms", true, now_);
  if (on) motion_.check_encoders(now_);
}

std::string ProcessData::enable_failure() const {
  return "the axes do not get beyond \"" + canopen::to_text(axes_[0]) + ", " + canopen::to_text(axes_[1]) +
         "\", error code " + std::to_string(fault_code_);
}

bool ProcessData::shows_no_torque() const {
  return !shows_torque() && !any_axis(DriveState::quick_stop_active);
}

void ProcessData::engage() {
  const bool edge = (cycles_++ / kResetCycles) % 2 == 1;
  send_command(canopen::control_word_towards_enabled(axes_[0], axes_[1], edge), 0.0, 0.0);
}

void ProcessData::drive(double left_rad_s, double right_rad_s) {
  send_command(canopen::kEnableOperation, left_rad_s, right_rad_s);
}

void ProcessData::stop() { send_command(canopen::kQuickStop, 0.0, 0.0); }

void ProcessData::release() { send_command(canopen::kDisableVoltage, 0.0, 0.0); }

/// A late word may have enabled an axis after the motion had ended. With another master it may be his; one
/// that only reads has no part in it.
double ProcessData::idle() {
  const bool late = !commanded_ && any_axis(DriveState::enabled);
  if (profile_.watchdog.kind != ProfileWatchdog::Kind::object && !late) return 0.0;
  release();
  return kIdleCycle_s;
}

void ProcessData::count_into(Counters& counters) const {
  counters["short_pdos"] = short_pdos_;
  counts_.count_into(counters);
  motion_.count_into(counters);
}

}  // namespace odomcalib::drivers
