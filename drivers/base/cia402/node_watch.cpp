#include "drivers/base/cia402/node_watch.hpp"

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/settings.hpp"
#include "drivers/base/motion/settings.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {
namespace {

using namespace cia402;

constexpr std::uint8_t kOperational = 0x05;
constexpr std::uint32_t kBusOff = 0x040;  // SocketCAN error classes
constexpr std::uint32_t kController = 0x004;

NodeWatch::Finding found(double now, const std::string& code, const std::string& text, bool stop) {
  return {ControllerEvent{now, code, text, stop}};
}

NodeWatch::Finding lost(double now, const std::string& code, const std::string& text) {
  return {ControllerEvent{now, code, text, true}, true};
}

}  // namespace

NodeWatch::Finding NodeWatch::on_error_frame(const CanFrame& frame, double now) {
  ++error_frames_;
  if ((frame.id & kBusOff) != 0)
    return found(now, "bus_off", "the CAN interface is off the bus; restart it", true);
  const bool passive = (frame.id & kController) != 0 && (frame.data[1] & 0x30) != 0;
  if (!passive) return {};
  return found(now, "error_passive", "the CAN interface is error-passive: check wiring and termination",
               true);
}

NodeWatch::Finding NodeWatch::on_emergency(const CanFrame& frame, double now) {
  if (frame.length != 8) {
    ++bad_frames_;
    return {};
  }
  ++emergencies_;
  ByteReader reader(Bytes(frame.data).first(frame.length));
  const std::uint16_t code = reader.u16();
  if (code == 0) return found(now, "emcy_cleared", "controller reports: error gone", false);
  return found(now, "emcy", "emergency of the controller: " + canopen::emergency_text(code), true);
}

NodeWatch::Finding NodeWatch::on_life_sign(const CanFrame& frame, const Situation& node, double now) {
  if (frame.length != 1) {
    ++bad_frames_;
    return {};
  }
  ++heartbeats_;
  heard_at_ = now;
  node_state_ = frame.data[0] & 0x7F;  // bit 7 is the toggle of node guarding
  if (node_state_ == 0) return on_boot_up(node, now);
  if (!node.ready || node_state_ == kOperational) return {};
  left_to_ = node_state_;
  const bool may_be_old = !node.moving && (node.job || node.fresh);
  if (!may_be_old) return left_operational(now);
  if (!left_at_) left_at_ = now;
  return {};
}

NodeWatch::Finding NodeWatch::left_operational(double now) const {
  return lost(now, "left_operational",
              "the controller left operational: it is " + canopen::nmt_state_text(left_to_));
}

/// Nothing moves while parameters are read or written, and a node that answers is there: the time-outs of the
/// requests find one that is not.
void NodeWatch::on_answer(const Situation& node, double now) {
  if (node.job) heard(now);
}

void NodeWatch::on_process_data(const Situation& node, double now) {
  if (node.job) heard(now);
  left_at_.reset();
}

/// Most controllers boot for longer than their life signs may be missing: then the stop was before.
NodeWatch::Finding NodeWatch::on_boot_up(const Situation& node, double now) {
  ++boot_ups_;
  Finding finding;
  const char* const text = "the controller restarted: its RAM parameters and PDO mapping are gone";
  if (!node.new_to_us)
    finding = lost(now, "unexpected_boot", text);
  else if (fell_silent_)
    finding = found(now, "unexpected_boot", text, false);
  fell_silent_ = false;
  finding.booted = true;
  return finding;
}

/// NMT, an SDO download, or process data to the node. An SDO client that only reads commands nothing.
bool NodeWatch::commands_node(const CanFrame& frame) const {
  if (frame.id == 0x000) return frame.length >= 2 && (frame.data[1] == 0 || frame.data[1] == profile_.node);
  if (frame.id != 0x600u + profile_.node) return true;
  constexpr unsigned kDownloadSegment = 0, kDownload = 1, kBlockDownload = 6;
  const unsigned specifier = frame.data[0] >> 5;
  return specifier == kDownloadSegment || specifier == kDownload || specifier == kBlockDownload;
}

/// A motion of the wheels that somebody else commands was not requested here (M19).
NodeWatch::Finding NodeWatch::on_other_master(const CanFrame& frame, const Situation& node, double now) {
  ++other_master_;
  const bool is_client = frame.id == 0x600u + profile_.node, is_nmt = frame.id == 0x000;
  double& last = is_client || is_nmt ? last_other_master_ : last_foreign_data_;
  const bool first = now - last > motion::kOtherMasterAgain_s;
  last = now;
  const bool commands = commands_node(frame);
  if (commands) ++foreign_commands_;
  if (commands && (is_client || is_nmt)) touched_at_ = now;
  const bool stops = node.moving && commands;
  if (!first && !stops) return {};
  return found(now, "other_master",
               is_nmt      ? "another program sends NMT commands on this bus"
               : is_client ? "another SDO client talks to this node"
                           : "another program sends speeds or control words to this node",
               stops);
}

NodeWatch::Finding NodeWatch::check(const Situation& node, double now) {
  if (node.ready && left_at_ && (node.moving || now - *left_at_ > kPositionsLive_s)) {
    left_at_.reset();
    return left_operational(now);
  }
  if (!node.ready || node.storing || !heard_at_) return {};
  const double longest = kMissedHeartbeats * 1e-3 * profile_.heartbeat_ms;
  if (now - *heard_at_ <= longest) return {};
  fell_silent_ = true;
  return lost(now, "heartbeat_lost", "three heartbeats of the controller are missing");
}

std::optional<CanFrame> NodeWatch::take_heartbeat(double now) {
  if (now < own_heartbeat_due_) return std::nullopt;
  own_heartbeat_due_ = now + kOwnHeartbeat_s;
  CanFrame frame;
  frame.id = 0x700u + profile_.host_node;
  frame.length = 1;
  frame.data[0] = kOperational;
  return frame;
}

void NodeWatch::was_read(double since) {
  if (touched_at_ && *touched_at_ < since) touched_at_.reset();
}

bool NodeWatch::other_master(double now) const { return now - last_other_master_ <= kOtherMaster_s; }

void NodeWatch::count_into(Counters& counters) const {
  counters.insert({{"emergencies", emergencies_},
                   {"boot_ups", boot_ups_},
                   {"heartbeats", heartbeats_},
                   {"bad_frames", bad_frames_},
                   {"other_master", other_master_},
                   {"error_frames", error_frames_}});
}

}  // namespace odomcalib::drivers
