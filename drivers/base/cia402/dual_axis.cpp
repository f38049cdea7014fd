// Life signs, emergencies, other masters; what comes in and goes out. Set-up and motion have their own files.
#include "drivers/base/cia402/dual_axis.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/settings.hpp"
#include "drivers/base/motion/settings.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {
namespace {

using namespace cia402;

constexpr std::uint8_t kOperational = 0x05;
constexpr std::uint8_t kNmtResetNode = 0x81;
constexpr std::uint32_t kBusOff = 0x040;  // SocketCAN error classes
constexpr std::uint32_t kController = 0x004;

}  // namespace

DualAxis::DualAxis(Profile profile)
    : profile_(std::move(profile)),
      sdo_(profile_.node),
      job_(profile_),
      motion_(*this,
              {profile_.name, profile_.max_rpm * std::numbers::pi / 30.0, profile_.ticks_per_rev, kRest_s}),
      dates_(profile_),
      counts_(profile_) {}

void DualAxis::event(const std::string& code, const std::string& text, bool stop) {
  motion_.event(code, text, stop, now_);
}

void DualAxis::on_frame(const CanFrame& frame) {
  ++frames_in_;
  now_ = std::max(now_, frame.t);
  if (frame.error) return on_error_frame(frame);
  if (frame.extended || frame.remote || frame.length > 8) return;
  if (sdo_.on_frame(frame, now_)) {
    ++frames_used_;
    advance_setup();
    return;
  }
  if (frame.id == 0x080) return on_sync(frame.t);
  if (frame.id == 0x080u + profile_.node) return on_emergency(frame);
  if (frame.id == 0x700u + profile_.node) return on_life_sign(frame);
  if (frame.id == 0x000 || frame.id == 0x600u + profile_.node) return on_other_master(frame);
  for (const canopen::Pdo& pdo : profile_.pdos)
    if (pdo.cob_id == frame.id) return pdo.transmit ? on_process_data(pdo, frame) : on_other_master(frame);
  if (receives(frame.id)) on_other_master(frame);
}

bool DualAxis::receives(std::uint32_t cob_id) const {
  return std::any_of(unlisted_.begin(), unlisted_.end(),
                     [&](const auto& pdo) { return (pdo.value & canopen::kPdoIdentifier) == cob_id; });
}

void DualAxis::on_error_frame(const CanFrame& frame) {
  ++error_frames_;
  if ((frame.id & kBusOff) != 0)
    return event("bus_off", "the CAN interface is off the bus; restart it", true);
  const bool passive = (frame.id & kController) != 0 && (frame.data[1] & 0x30) != 0;
  if (passive)
    event("error_passive", "the CAN interface is error-passive: check wiring and termination", true);
}

void DualAxis::on_emergency(const CanFrame& frame) {
  if (frame.length != 8) {
    ++bad_frames_;
    return;
  }
  ++frames_used_;
  ++emergencies_;
  ByteReader reader(Bytes(frame.data).first(frame.length));
  const std::uint16_t code = reader.u16();
  if (code == 0) return event("emcy_cleared", "controller reports: error gone", false);
  event("emcy", "emergency of the controller: " + canopen::emergency_text(code), true);
}

void DualAxis::on_life_sign(const CanFrame& frame) {
  if (frame.length != 1) {
    ++bad_frames_;
    return;
  }
  ++frames_used_;
  ++heartbeats_;
  heard_at_ = now_;
  node_state_ = frame.data[0] & 0x7F;  // bit 7 is the toggle of node guarding
  if (node_state_ == 0) return on_boot_up();
  if (phase_ == Phase::ready && node_state_ != kOperational)
    lose("left_operational",
         "the controller left operational: it is " + canopen::nmt_state_text(node_state_));
}

/// Most controllers boot for longer than their life signs may be missing: then the stop was before.
void DualAxis::on_boot_up() {
  ++boot_ups_;
  const bool expected = phase_ == Phase::absent || phase_ == Phase::identifying;
  const char* const text = "the controller restarted: its RAM parameters and PDO mapping are gone";
  if (!expected)
    lose("unexpected_boot", text);
  else if (fell_silent_)
    event("unexpected_boot", text, false);
  fell_silent_ = false;
  look_after_ = now_;
}

/// NMT, an SDO download, or process data to the node. An SDO client that only reads commands nothing.
bool DualAxis::commands_node(const CanFrame& frame) const {
  if (frame.id == 0x000) return frame.length >= 2 && (frame.data[1] == 0 || frame.data[1] == profile_.node);
  if (frame.id != 0x600u + profile_.node) return true;
  constexpr unsigned kDownloadSegment = 0, kDownload = 1, kBlockDownload = 6;
  const unsigned specifier = frame.data[0] >> 5;
  return specifier == kDownloadSegment || specifier == kDownload || specifier == kBlockDownload;
}

/// Our own frames do not come back. What moves the wheels while somebody else commands them was not asked for
/// here (M19).
void DualAxis::on_other_master(const CanFrame& frame) {
  ++other_master_;
  const bool is_client = frame.id == 0x600u + profile_.node, is_nmt = frame.id == 0x000;
  double& last = is_client || is_nmt ? last_other_master_ : last_foreign_data_;
  const bool first = now_ - last > motion::kOtherMasterAgain_s;
  last = now_;
  const bool commands = commands_node(frame);
  if (commands) ++foreign_commands_;
  if (commands && (is_client || is_nmt)) touched_at_ = now_;
  const bool stops = motion_.active() && commands;
  if (!first && !stops) return;
  event("other_master",
        is_nmt      ? "another program sends NMT commands on this bus"
        : is_client ? "another SDO client talks to this node"
                    : "another program sends speeds or control words to this node",
        stops);
}

void DualAxis::check_life() {
  if (phase_ != Phase::ready || job_.storing() || !heard_at_) return;
  const double longest = kMissedHeartbeats * 1e-3 * profile_.heartbeat_ms;
  if (now_ - *heard_at_ <= longest) return;
  lose("heartbeat_lost", "three heartbeats of the controller are missing");
  fell_silent_ = true;
}

/// The node is no longer what was configured: stop, forget, look again.
void DualAxis::lose(const std::string& code, const std::string& text) {
  event(code, text, true);
  job_.abandon();
  forget_node();
  look_after_ = now_ + kLostAgain_s;
}

void DualAxis::forget_node() {
  motion_.forget();
  setup_.cancel();
  sdo_.cancel();
  phase_ = Phase::absent;
  phase_since_ = now_;
  watchdog_armed_ = false;
  positions_at_.reset();
  dates_.forget();
  status_at_.reset();
  counts_.begin_segment();
}

/// What a store is worth is seen after a reset only. Everything in RAM is set up again afterwards.
void DualAxis::restart_to_verify() {
  event("restarted_to_verify", "the controller is reset to see what it stored", false);
  restarted_at_ = now_;
  fell_silent_ = false;
  send_nmt(kNmtResetNode);
  forget_node();
  look_after_ = now_ + kBoot_s;  // a boot-up message makes it sooner
}

void DualAxis::send_nmt(std::uint8_t command) {
  CanFrame frame;
  frame.id = 0x000;
  frame.length = 2;
  frame.data = {command, profile_.node};
  out_.push_back(frame);
}

void DualAxis::send_own_heartbeat() {
  const bool watched = phase_ == Phase::configuring || phase_ == Phase::starting || phase_ == Phase::ready;
  if (!watched || now_ < own_heartbeat_due_) return;
  own_heartbeat_due_ = now_ + kOwnHeartbeat_s;
  CanFrame frame;
  frame.id = 0x700u + profile_.host_node;
  frame.length = 1;
  frame.data[0] = kOperational;
  out_.push_back(frame);
}

/// A drive that is not as it was set up is set up again; until then its state is not that of one that may
/// move.
void DualAxis::advance_job() {
  const bool reading = job_.reading();
  job_.advance(sdo_, now_);
  if (const auto change = job_.take_change()) return lose("drive_changed", change->what);
  if (reading && !job_.running() && touched_at_ && *touched_at_ < read_since_) touched_at_.reset();
}

void DualAxis::on_time(double now) {
  now_ = std::max(now_, now);
  sdo_.on_time(now_);
  advance_setup();
  if (phase_ == Phase::ready) advance_job();
  if (job_.take_reset_request()) restart_to_verify();
  if (job_.resetting() && now_ - restarted_at_ > kRestart_s) job_.abandon();
  send_own_heartbeat();
  send_sync();
  check_life();
  cycle_motion();
}

/// For drives that sample on SYNC. One of a pair leaves it to the pair.
void DualAxis::send_sync() {
  if (profile_.sync_period_s <= 0.0 || profile_.axes == 1 || !wants_sync() || now_ < sync_due_) return;
  const bool in_time = now_ - sync_due_ < profile_.sync_period_s;
  sync_due_ = (in_time ? sync_due_ : now_) + profile_.sync_period_s;
  CanFrame frame;
  frame.id = 0x080;
  out_.push_back(frame);
  on_sync(now_);
}

std::vector<CanFrame> DualAxis::take_frames() {
  for (CanFrame& frame : sdo_.take_frames()) out_.push_back(frame);
  return std::exchange(out_, {});
}

ControllerState DualAxis::state() const {
  switch (phase_) {
    case Phase::absent:
      return ControllerState::absent;
    case Phase::foreign:
      return ControllerState::fault;
    case Phase::identifying:
      return heard_at_ ? ControllerState::configuring : ControllerState::absent;
    case Phase::configuring:
    case Phase::starting:
      return ControllerState::configuring;
    case Phase::ready:
      break;
  }
  using enum canopen::DriveState;
  if (motion_.enabling()) return ControllerState::enabling;
  if (any_axis(fault) || any_axis(fault_reaction)) return ControllerState::fault;
  // While the axes are brought to rest they still have torque: not disabled before the drive says so, and not
  // before it may be given a job.
  const bool ending = motion_.motion() == Motion::disabling || motion_.motion() == Motion::stopping;
  return ending || any_axis(enabled) ? ControllerState::enabled : ControllerState::disabled;
}

Counters DualAxis::counters() const {
  Counters all = sdo_.counters();
  all.insert({{"frames_in", frames_in_},
              {"frames_used", frames_used_},
              {"emergencies", emergencies_},
              {"boot_ups", boot_ups_},
              {"heartbeats", heartbeats_},
              {"bad_frames", bad_frames_},
              {"short_pdos", short_pdos_},
              {"other_master", other_master_},
              {"error_frames", error_frames_}});
  counts_.count_into(all);
  motion_.count_into(all);
  return all;
}

Result<void> DualAxis::job_allowed() const {
  const std::string where = "controller " + profile_.name;
  if (phase_ != Phase::ready)
    return Error{ErrorCode::refused, "controller is not configured", where, "wait until it is"};
  if (motion_.motion() != Motion::off || any_axis(canopen::DriveState::enabled))
    return Error{ErrorCode::refused, "axes are not disabled", where, "stop and disable first"};
  if (job_.running())
    return Error{ErrorCode::refused, "another parameter job is in progress", where, "wait for it"};
  return {};
}

/// What changes the geometry waits for rest. Reading does not: after a start, rest is known only when counts
/// have come for a while.
Result<void> DualAxis::change_allowed(double now) {
  now_ = std::max(now_, now);
  if (auto allowed = job_allowed(); !allowed) return allowed;
  if (at_rest()) return {};
  return Error{ErrorCode::refused, "wheels are turning", "controller " + profile_.name,
               "wait until the robot stands still"};
}

Result<void> DualAxis::start_read_parameters(double now) {
  now_ = std::max(now_, now);
  if (auto allowed = job_allowed(); !allowed) return allowed;
  read_since_ = now_;
  return job_.start_read(as_set_up_);
}

Result<void> DualAxis::start_write_parameters(const std::vector<ParameterValue>& values, double now) {
  if (auto allowed = change_allowed(now); !allowed) return allowed;
  return job_.start_write(values);
}

Result<void> DualAxis::start_store(double now) {
  if (auto allowed = change_allowed(now); !allowed) return allowed;
  return job_.start_store();
}

std::vector<Capability> DualAxis::capabilities() const {
  std::vector<Capability> all = host_capabilities();
  for (Capability& one : all)
    for (const ProfileParameter& parameter : profile_.parameters)
      if (parameter.quantity == one.quantity)
        one = {one.quantity,    true, true, profile_.store.has_value(), canopen::to_text(parameter.object),
               parameter.step()};
  return all;
}

}  // namespace odomcalib::drivers
