#include "drivers/base/cia402/dual_axis.hpp"

#include <algorithm>
#include <utility>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/settings.hpp"

namespace odomcalib::drivers {

using namespace cia402;

DualAxis::DualAxis(Profile profile)
    : profile_(std::move(profile)),
      sdo_(profile_.node),
      setup_(profile_, out_),
      watch_(profile_),
      data_(profile_, out_),
      job_(profile_) {}

void DualAxis::event(const ControllerEvent& found) { data_.event(found.code, found.text, found.stop, now_); }

void DualAxis::on_frame(const CanFrame& frame) {
  ++frames_in_;
  now_ = std::max(now_, frame.t);
  if (frame.error) return take(watch_.on_error_frame(frame, now_));
  if (frame.extended || frame.remote || frame.length > 8) return;
  if (sdo_.on_frame(frame, now_)) {
    ++answers_;
    watch_.on_answer(situation(), now_);
    advance_setup();
    return;
  }
  if (frame.id == 0x080) return on_sync(frame.t);
  if (frame.id == 0x080u + profile_.node) return take(watch_.on_emergency(frame, now_));
  if (frame.id == 0x700u + profile_.node) return take(watch_.on_life_sign(frame, situation(), now_));
  if (frame.id == 0x000 || frame.id == 0x600u + profile_.node) return on_other_master(frame);
  for (const canopen::Pdo& pdo : profile_.pdos) {
    if (pdo.cob_id != frame.id) continue;
    if (!pdo.transmit) return on_other_master(frame);
    watch_.on_process_data(situation(), now_);
    return data_.on_frame(pdo, frame, setup_.started(), now_);
  }
  if (setup_.receives(frame.id)) on_other_master(frame);
}

void DualAxis::on_other_master(const CanFrame& frame) {
  take(watch_.on_other_master(frame, situation(), now_));
}

NodeWatch::Situation DualAxis::situation() const {
  const Phase phase = setup_.phase();
  return {phase == Phase::absent || phase == Phase::identifying,
          setup_.ready(),
          data_.motion().active(),
          job_.storing(),
          job_.running(),
          now_ - started_at_ <= canopen::kSdoSettles_s};
}

void DualAxis::take(const NodeWatch::Finding& finding) {
  if (finding.lost)
    lose(*finding.event);
  else if (finding.event)
    event(*finding.event);
  if (finding.booted) setup_.look_now(now_);
}

/// The node is no longer what was configured: stop, forget, look again.
void DualAxis::lose(const ControllerEvent& why) {
  event(why);
  job_.abandon();
  forget_node(kLostAgain_s);
}

void DualAxis::forget_node(double pause) {
  setup_.begin_again(now_, pause);
  sdo_.cancel();
  data_.forget();
}

/// The effect of a store is seen after a reset only. Everything in RAM is set up again afterwards.
void DualAxis::restart_to_verify() {
  event({now_, "restarted_to_verify", "the controller is reset to see what it stored", false});
  restarted_at_ = now_;
  watch_.expect_boot();
  setup_.reset_node();
  forget_node(kBoot_s);  // a boot-up message makes it sooner
}

void DualAxis::send_own_heartbeat() {
  if (setup_.phase() != Phase::configuring && !setup_.started()) return;
  if (const auto frame = watch_.take_heartbeat(now_)) out_.push_back(*frame);
}

void DualAxis::advance_setup() {
  if (setup_.ready()) return advance_job();
  const NodeSetup::Step step = setup_.advance(
      sdo_, {watch_.other_master(now_), watch_.node_state(), data_.has_positions(), data_.has_status()},
      now_);
  for (const ControllerEvent& found : setup_.take_events()) event(found);
  switch (step) {
    case NodeSetup::Step::none:
      return;
    case NodeSetup::Step::no_answer:
      return watch_.unheard();
    case NodeSetup::Step::identified:
      return watch_.heard(now_);
    case NodeSetup::Step::configured:
      watch_.was_set_up();
      started_at_ = now_;
      return data_.expect();
    case NodeSetup::Step::running:
      data_.begin_motion();
      watch_.heard(now_);
      return job_.on_set_up_again();
  }
}

/// A drive that is not as it was set up is set up again; until then its state is not that of one that may
/// move.
void DualAxis::advance_job() {
  const bool reading = job_.reading();
  job_.advance(sdo_, now_);
  if (const auto change = job_.take_change()) return lose({now_, "drive_changed", change->what, true});
  if (reading && !job_.running()) watch_.was_read(read_since_);
}

void DualAxis::on_time(double now) {
  now_ = std::max(now_, now);
  sdo_.on_time(now_);
  advance_setup();
  if (setup_.ready()) advance_job();
  if (job_.take_reset_request()) restart_to_verify();
  if (job_.resetting() && now_ - restarted_at_ > kRestart_s) job_.abandon();
  send_own_heartbeat();
  send_sync();
  take(watch_.check(situation(), now_));
  if (setup_.ready()) data_.cycle(watch_.was_commanded(), now_);
}

/// One of a pair leaves it to the pair.
void DualAxis::send_sync() {
  if (profile_.sync_period_s > 0.0 && profile_.axes == 2 && wants_sync()) data_.sync(now_);
}

std::vector<CanFrame> DualAxis::take_frames() {
  for (CanFrame& frame : sdo_.take_frames()) out_.push_back(frame);
  return std::exchange(out_, {});
}

ControllerState DualAxis::state() const {
  switch (setup_.phase()) {
    case Phase::absent:
      return ControllerState::absent;
    case Phase::foreign:
      return ControllerState::fault;
    case Phase::identifying:
      return watch_.hears() ? ControllerState::configuring : ControllerState::absent;
    case Phase::configuring:
    case Phase::starting:
      return ControllerState::configuring;
    case Phase::ready:
      break;
  }
  using enum canopen::DriveState;
  const MotionCycle& motion = data_.motion();
  if (motion.enabling()) return ControllerState::enabling;
  if (data_.any_axis(fault) || data_.any_axis(fault_reaction)) return ControllerState::fault;
  // While the axes are brought to rest they still have torque: not disabled before the drive says so, and not
  // before it may be given a job.
  const bool ending = motion.motion() == Motion::disabling || motion.motion() == Motion::stopping;
  return ending || data_.any_axis(enabled) ? ControllerState::enabled : ControllerState::disabled;
}

void DualAxis::enable(double now) {
  now_ = std::max(now_, now);
  data_.enable(enable_refusal(), now_);
}

void DualAxis::disable(double now) {
  now_ = std::max(now_, now);
  data_.disable(now_);
}

void DualAxis::quick_stop(double now) {
  now_ = std::max(now_, now);
  const bool known = setup_.identity() && setup_.phase() != Phase::foreign;
  if (known) data_.quick_stop(now_);
}

Result<void> DualAxis::command(double left_rad_s, double right_rad_s, double now) {
  now_ = std::max(now_, now);
  return data_.command(left_rad_s, right_rad_s, now_);
}

std::string DualAxis::enable_refusal() const {
  if (!setup_.ready()) return "the controller is not configured";
  if (!setup_.watchdog_armed()) return "the controller would not stop by itself if this program died";
  return job_.running() ? "a parameter job is in progress" : "";
}

Counters DualAxis::counters() const {
  Counters all = sdo_.counters();
  all.insert({{"frames_in", frames_in_}, {"frames_used", answers_ + watch_.used() + data_.used()}});
  watch_.count_into(all);
  data_.count_into(all);
  return all;
}

Result<void> DualAxis::job_allowed() const {
  const std::string where = "controller " + profile_.name;
  if (!setup_.ready())
    return Error{ErrorCode::refused, "controller is not configured", where, "wait until it is"};
  if (data_.motion().motion() != Motion::off || data_.any_axis(canopen::DriveState::enabled))
    return Error{ErrorCode::refused, "axes are not disabled", where, "stop and disable first"};
  if (job_.running())
    return Error{ErrorCode::refused, "another parameter job is in progress", where, "wait for it"};
  return {};
}

/// A change of the geometry waits for rest. Reading does not: after a start, rest is known only when counts
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
  return job_.start_read(setup_.as_set_up());
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
