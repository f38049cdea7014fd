// Network side of the node: NMT, life signs, SDO and PDO traffic. Its objects are in drive_objects.cpp.
#include "tests/sim/wires/drive_node.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

constexpr double kRatedSpeed = 200.0 * 2.0 * std::numbers::pi / 60.0;  // rad/s, what the ramp times refer to
constexpr double kAtRest = 0.02;                                       // rad/s
constexpr std::uint16_t kHeartbeatLost = 0x8130, kRpdoTimeout = 0x8250;
constexpr std::uint8_t kCommunicationError = 0x11;

}  // namespace

DriveNode::DriveNode(const DriveNodeOptions& options) : options_(options), stored_(options.geometry_um) {
  reset(0.0);
}

void DriveNode::reset(double now) {
  dictionary_ = ObjectDictionary();
  const SdoFaults kept = sdo_ ? sdo_->faults : SdoFaults{};
  sdo_ = std::make_unique<SdoServer>(dictionary_);
  sdo_->faults = kept;
  machine_.reset();
  machine_.options = StopOptions{};
  build_dictionary();
  outgoing_.clear();
  zero_ = wheels_.counts;
  master_seen_.reset();
  connection_lost_ = false;
  nmt_ = NmtState::booting;
  boot_at_ = now + options_.boot_time;
}

void DriveNode::send(const Frame& frame, double due) { outgoing_.push_back({due, frame}); }

std::vector<Frame> DriveNode::take_frames(double now) {
  std::stable_sort(outgoing_.begin(), outgoing_.end(),
                   [](const Outgoing& a, const Outgoing& b) { return a.due < b.due; });
  std::vector<Frame> out;
  while (!outgoing_.empty() && outgoing_.front().due <= now) {
    out.push_back(outgoing_.front().frame);
    outgoing_.pop_front();
  }
  return out;
}

void DriveNode::receive(const Frame& frame, double now) {
  if (nmt_ == NmtState::booting || frame.extended || frame.remote) return;
  if (frame.id == 0x000) return on_nmt(frame, now);
  if (nmt_ == NmtState::stopped) return;
  if (frame.id == 0x080) return on_sync();
  if (frame.id == 0x600U + options_.node_id) return on_sdo(frame, now);
  if (frame.id > 0x700) return on_heartbeat(frame, now);
  if (nmt_ == NmtState::operational) on_rpdo(frame, now);
}

void DriveNode::on_nmt(const Frame& frame, double now) {
  if (frame.length < 2 || (frame.data[1] != 0 && frame.data[1] != options_.node_id)) return;
  switch (frame.data[0]) {
    case 0x01:
      return enter(NmtState::operational, now);
    case 0x02:
      return enter(NmtState::stopped, now);
    case 0x80:
      return enter(NmtState::pre_operational, now);
    case 0x81:
      return reset(now);
    case 0x82:
      nmt_ = NmtState::booting;  // communication restarts, application objects stay
      boot_at_ = now + options_.boot_time;
      return machine_.disable_voltage();
    default:
      return;
  }
}

void DriveNode::enter(NmtState state, double now) {
  if (state == nmt_) return;
  // Without PDOs nobody could stop the motors any more.
  if (nmt_ == NmtState::operational && machine_.enabled()) machine_.quick_stop();
  nmt_ = state;
  last_life_sign_ = -1e9;  // the new state is told at once
  if (state != NmtState::operational) return;
  for (TransmitPdo& pdo : tpdos_) pdo.start(now);
  for (ReceivePdo& pdo : rpdos_) pdo.start();
}

void DriveNode::on_heartbeat(const Frame& frame, double now) {
  const std::uint32_t consumer = dictionary_.value({0x1016, 1});
  const std::uint32_t producer = (consumer >> 16U) & 0x7FU;
  if (producer != 0 && (consumer & 0xFFFFU) != 0 && frame.id == 0x700U + producer && frame.length >= 1) {
    master_seen_ = now;
    connection_lost_ = false;
  }
}

void DriveNode::on_sdo(const Frame& frame, double now) {
  SdoBytes request{};
  if (frame.length != request.size()) return;
  request = frame.data;
  const auto answer = sdo_->answer(request);
  if (!answer) return;
  Frame out;
  out.id = 0x580U + options_.node_id;
  out.length = 8;
  out.data = *answer;
  const bool stores = sdo_->last_key().index == 0x1010 && (*answer)[0] == 0x60;
  const auto planned = sdo_->faults.answer_delay.find(sdo_->last_key());
  const double extra = planned == sdo_->faults.answer_delay.end() ? 0.0 : planned->second;
  send(out, now + extra + (stores ? options_.store_time : options_.answer_time));
}

void DriveNode::on_rpdo(const Frame& frame, double now) {
  for (ReceivePdo& pdo : rpdos_) {
    if (!pdo.valid() || pdo.id() != frame.id) continue;
    if (!pdo.on_frame(frame, now)) report_error(0x8210, kCommunicationError, now);
  }
}

void DriveNode::on_sync() {
  if (nmt_ != NmtState::operational) return;
  for (ReceivePdo& pdo : rpdos_) pdo.on_sync();
  if (faults.pdo_silent) return;
  for (TransmitPdo& pdo : tpdos_)
    if (const auto frame = pdo.on_sync(faults.pdo_frozen))
      send(*frame, now_ + faults.pdo_delay + wheels_.lateness);
}

void DriveNode::advance(double now, const WheelState& wheels) {
  now_ = now;
  wheels_ = wheels;
  if (nmt_ == NmtState::booting) {
    if (now < boot_at_) return;
    nmt_ = NmtState::pre_operational;
    last_life_sign_ = now;
    send(make_frame(0x700U + options_.node_id, {0}), now);
  }
  machine_.update(std::abs(wheels.rate[0]) < kAtRest && std::abs(wheels.rate[1]) < kAtRest);
  if (machine_.take_fault_reset()) {
    dictionary_.set({0x1001, 0}, 0);
    dictionary_.set({0x603F, 0}, 0);
    report_error(0, 0, now);
  }
  watch_master(now);
  send_life_sign(now);
  send_tpdos(now);
}

void DriveNode::watch_master(double now) {
  const double limit = 1e-3 * (dictionary_.value({0x1016, 1}) & 0xFFFFU);
  if (limit <= 0.0) master_seen_.reset();
  if (master_seen_ && now - *master_seen_ > limit) {
    master_seen_.reset();  // monitoring starts again with the next heartbeat
    lost_connection(kHeartbeatLost, now);
  }
  for (const ReceivePdo& pdo : rpdos_)
    if (nmt_ == NmtState::operational && pdo.valid() && pdo.timed_out(now) && !connection_lost_)
      lost_connection(kRpdoTimeout, now);
}

void DriveNode::lost_connection(std::uint16_t code, double now) {
  connection_lost_ = true;
  report_error(code, kCommunicationError, now);
  abort_connection();
  const std::uint32_t behaviour = dictionary_.value({0x1029, 1});
  if (behaviour == 0 && nmt_ == NmtState::operational) enter(NmtState::pre_operational, now);
  if (behaviour == 2) enter(NmtState::stopped, now);
}

void DriveNode::abort_connection() {
  switch (dictionary_.value({0x6007, 0}) & 0xFFFFU) {
    case 1:
      return machine_.fault();
    case 2:
      return machine_.disable_voltage();
    case 3:
      return machine_.quick_stop();
    default:
      return;
  }
}

void DriveNode::send_life_sign(double now) {
  const double period = 1e-3 * dictionary_.value({0x1017, 0});
  constexpr double kHalfStep = 0.0005;
  if (period <= 0.0 || faults.heartbeat_stopped || now - last_life_sign_ + kHalfStep < period) return;
  last_life_sign_ = now;
  send(make_frame(0x700U + options_.node_id, {static_cast<int>(nmt_)}), now);
}

void DriveNode::send_tpdos(double now) {
  if (nmt_ != NmtState::operational || faults.pdo_silent) return;
  for (TransmitPdo& pdo : tpdos_)
    if (const auto frame = pdo.poll(now, faults.pdo_frozen)) send_tpdo(*frame, now);
}

void DriveNode::send_tpdo(const Frame& frame, double now) {
  const double due = now + faults.pdo_delay + wheels_.lateness;
  const auto held = held_back_.find(frame.id);
  if (faults.pdo_reordered && held == held_back_.end()) {
    held_back_.emplace(frame.id, frame);
    return;
  }
  send(frame, due);
  if (held == held_back_.end()) return;
  send(held->second, due);
  held_back_.erase(held);
}

void DriveNode::report_error(std::uint16_t code, std::uint8_t error_register, double now) {
  if (code != 0) {
    for (std::uint8_t i = 4; i > 1; --i)
      dictionary_.set({0x1003, i}, dictionary_.value({0x1003, static_cast<std::uint8_t>(i - 1)}));
    dictionary_.set({0x1003, 1}, code);
    dictionary_.set({0x1003, 0}, std::min(4U, dictionary_.value({0x1003, 0}) + 1U));
    dictionary_.set({0x603F, 0}, code | static_cast<std::uint32_t>(code) << 16U);
    dictionary_.set({0x1001, 0}, error_register);
  }
  if (nmt_ == NmtState::stopped) return;
  send(make_frame(0x080U + options_.node_id, {code & 0xFF, code >> 8, error_register, 0, 0, 0, 0, 0}), now);
}

void DriveNode::emergency(std::uint16_t code, std::uint8_t error_register, double now) {
  report_error(code, error_register, now);
  if (code != 0) machine_.fault();
}

double DriveNode::ramp(std::uint16_t index) const {
  const double slower = std::max(dictionary_.value({index, 1}), dictionary_.value({index, 2}));
  return kRatedSpeed / std::max(1e-3, 1e-3 * slower);
}

MotorOrder DriveNode::order() const {
  MotorOrder order;
  const MotorAction action = machine_.action();
  order.torque = action != MotorAction::free;
  order.acceleration = ramp(0x6083);
  order.deceleration = ramp(action == MotorAction::quick_stop ? 0x6085 : 0x6084);
  const bool velocity_mode = dictionary_.value({0x6061, 0}) == 3;
  if (action != MotorAction::follow || !velocity_mode) return order;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto target =
        static_cast<std::int32_t>(dictionary_.value({0x60FF, static_cast<std::uint8_t>(side + 1)}));
    const std::size_t motor = faults.swap_motors ? 1 - side : side;
    const double rate = std::clamp(0.01 * target * 2.0 * std::numbers::pi / 60.0, -kRatedSpeed, kRatedSpeed);
    order.rate[motor] = faults.motor_inverted[motor] ? -rate : rate;
  }
  return order;
}

}  // namespace odomcalib::sim
