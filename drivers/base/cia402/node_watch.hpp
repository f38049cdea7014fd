// Supervision of a CANopen node: its life signs and ours, its emergencies, errors of the bus, and who else
// talks to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

/// Judges frames and the time that passes. It neither stops nor forgets anything: it says what it found.
class NodeWatch {
 public:
  /// State of the rest of the driver towards the node.
  struct Situation {
    bool new_to_us = false;  ///< not configured yet: a boot-up message is no surprise
    bool ready = false;      ///< configured
    bool moving = false;     ///< torque is wanted
    bool storing = false;    ///< the node is busy for seconds and its life signs may be late
    bool job = false;        ///< its parameters are read or written: it is asked all the time, without torque
    bool fresh = false;      ///< life signs that it sent before it was started may still come
  };
  struct Finding {
    std::optional<ControllerEvent> event;
    bool lost = false;    ///< the node is no longer what was configured
    bool booted = false;  ///< it has just started
  };

  /// @param profile outlives this
  explicit NodeWatch(const Profile& profile) : profile_(profile) {}

  // Frames, by what they are.
  Finding on_error_frame(const CanFrame& frame, double now);
  Finding on_emergency(const CanFrame& frame, double now);
  Finding on_life_sign(const CanFrame& frame, const Situation& node, double now);
  /// An answer to one of our requests.
  void on_answer(const Situation& node, double now);
  /// Process data of the node. It sends them in no other state than operational.
  void on_process_data(const Situation& node, double now);
  /// NMT, an SDO request, or process data to the node. Our own frames do not come back.
  Finding on_other_master(const CanFrame& frame, const Situation& node, double now);

  /// Life signs that are missing.
  Finding check(const Situation& node, double now);
  /// Our own life sign, when it is due.
  std::optional<CanFrame> take_heartbeat(double now);

  /// The node has answered, or begins to be watched.
  void heard(double now) { heard_at_ = now; }
  /// It does not answer.
  void unheard() { heard_at_.reset(); }
  /// It is reset by us: that it boots is expected.
  void expect_boot() { fell_silent_ = false; }
  /// Its objects were read from this time on: earlier changes by others are known.
  /// @param since s, begin of the reading
  void was_read(double since);
  /// It was set up anew: nothing is left of what others changed.
  void was_set_up() {
    touched_at_.reset();
    left_at_.reset();
  }

  [[nodiscard]] bool hears() const { return heard_at_.has_value(); }
  /// As its last life sign said.
  [[nodiscard]] std::uint8_t node_state() const { return node_state_; }
  /// s, when somebody else last did something that may have changed the node, see Controller::touched()
  [[nodiscard]] std::optional<double> touched() const { return touched_at_; }
  /// Another master was at work a moment ago.
  [[nodiscard]] bool other_master(double now) const;
  /// Somebody else has ever commanded the node.
  [[nodiscard]] bool was_commanded() const { return foreign_commands_ > 0; }
  /// Frames that were understood.
  [[nodiscard]] std::uint64_t used() const { return emergencies_ + heartbeats_; }
  /// Adds emergencies, boot_ups, heartbeats, bad_frames, other_master and error_frames.
  void count_into(Counters& counters) const;

 private:
  Finding on_boot_up(const Situation& node, double now);
  [[nodiscard]] Finding left_operational(double now) const;
  [[nodiscard]] bool commands_node(const CanFrame& frame) const;

  const Profile& profile_;
  std::optional<double> heard_at_;  // s, last life sign
  bool fell_silent_ = false;        // was lost for want of life signs and has not booted since
  std::uint8_t node_state_ = 0;
  std::optional<double> left_at_;  // s, when a life sign said so that may be an old one
  std::uint8_t left_to_ = 0;       // the state that it named
  double own_heartbeat_due_ = 0.0;
  double last_other_master_ = -1e9, last_foreign_data_ = -1e9;
  std::optional<double> touched_at_;  // s, when somebody else was last seen to change the node
  std::uint64_t emergencies_ = 0, boot_ups_ = 0, heartbeats_ = 0, bad_frames_ = 0;
  std::uint64_t other_master_ = 0, error_frames_ = 0;
  std::uint64_t foreign_commands_ = 0;  // of other_master_, those that may have changed what the node does
};

}  // namespace odomcalib::drivers
