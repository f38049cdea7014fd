// A CANopen dual-axis drive (CiA 301, CiA 402) in the manner of the ZLAC8015D, with wheel geometry in its
// memory.
//
// Differences from the real ZLAC8015D: heartbeat and event timers count in milliseconds; it watches the
// master's heartbeat (1016h) and leaves operational when it is lost (1029h); targets (60FFh) are in 0.01 rpm;
// the right side is not mirrored; objects 2100:01..03 hold left and right wheel diameter and track width in
// micrometres. The diameters are storage only: wheel speeds do not depend on them. Ramp times (6083h to
// 6085h) are those from rest to the rated speed of 200 rpm.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "tests/sim/wires/drive_state.hpp"
#include "tests/sim/wires/frame.hpp"
#include "tests/sim/wires/object_dictionary.hpp"
#include "tests/sim/wires/pdo.hpp"
#include "tests/sim/wires/sdo_server.hpp"

namespace odomcalib::sim {

enum class NmtState : std::uint8_t {
  booting = 0xFF,
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F
};

/// State of the wheels that the node sees.
struct WheelState {
  std::array<std::int64_t, 2> counts{};
  std::array<double, 2> rate{};  ///< rad/s
  double lateness = 0.0;         ///< s that what is read now takes longer to the bus
};

/// Motion that the node wants from the motors.
struct MotorOrder {
  bool torque = false;
  std::array<double, 2> rate{};  ///< rad/s
  double acceleration = 0.0;     ///< rad/s^2
  double deceleration = 0.0;     ///< rad/s^2
};

struct DriveNodeOptions {
  std::uint8_t node_id = 1;
  std::uint32_t serial = 4242;
  std::array<std::uint32_t, 3> geometry_um{150000, 150000, 400000};  ///< left, right diameter, track width
  double boot_time = 0.2;                                            ///< s from reset to the boot-up message
  double answer_time = 0.0003;                                       ///< s, SDO
  double store_time = 0.05;                                          ///< s, answer to 1010h
  /// One axis only: 6063:00 in increments, 6064:00 in um by the feed constant, 60FF:00, a status word of 16
  /// bits, and 6092:01 as the feed of 100 turns in um.
  bool single_axis = false;
  double increments_per_turn = 65536.0;  ///< of a wheel; 6064 of a single axis depends on it
};

/// Switches for tests; all off by default.
struct NodeFaults {
  bool heartbeat_stopped = false;
  bool pdo_silent = false;               ///< no TPDO is sent
  bool pdo_frozen = false;               ///< TPDOs go on with the content of the last one
  double pdo_delay = 0.0;                ///< s, every TPDO leaves later
  bool pdo_reordered = false;            ///< of each two TPDOs with one identifier the second leaves first
  bool store_fails = false;              ///< 1010h is answered with a hardware error
  bool store_is_lost = false;            ///< 1010h is answered well, and nothing is stored
  bool swap_sides = false;               ///< positions and actual speeds of left and right exchanged
  bool swap_motors = false;              ///< cables of left and right exchanged
  std::array<bool, 2> motor_inverted{};  ///< two wires of the left, right motor exchanged
};

class DriveNode {
 public:
  explicit DriveNode(const DriveNodeOptions& options);

  void receive(const Frame& frame, double now);
  /// Call every millisecond.
  void advance(double now, const WheelState& wheels);
  /// Frames that left the node up to now.
  std::vector<Frame> take_frames(double now);
  [[nodiscard]] MotorOrder order() const;

  /// Reset as after power-on: RAM parameters become the stored ones, counters start at zero.
  void reset(double now);
  /// Sends an emergency message and goes to fault (code 0: only the message).
  void emergency(std::uint16_t code, std::uint8_t error_register, double now);

  [[nodiscard]] NmtState nmt_state() const { return nmt_; }
  [[nodiscard]] DriveState drive_state() const { return machine_.state(); }
  [[nodiscard]] std::array<std::uint32_t, 3> geometry_in_ram() const;
  [[nodiscard]] const std::array<std::uint32_t, 3>& geometry_stored() const { return stored_; }
  [[nodiscard]] unsigned store_count() const { return store_count_; }
  ObjectDictionary& dictionary() { return dictionary_; }
  SdoFaults& sdo_faults() { return sdo_->faults; }
  NodeFaults faults;

 private:
  struct Outgoing {
    double due;
    Frame frame;
  };

  void build_dictionary();
  void add_identity();
  void add_errors();
  void add_life_signs();
  void add_drive_objects();
  void add_targets();
  void add_actual_values();
  void add_geometry();
  void add_single_axis();
  void add_pdos();
  void on_nmt(const Frame& frame, double now);
  void on_heartbeat(const Frame& frame, double now);
  void on_sdo(const Frame& frame, double now);
  void on_rpdo(const Frame& frame, double now);
  void on_sync();
  void enter(NmtState state, double now);
  void watch_master(double now);
  void lost_connection(std::uint16_t code, double now);
  void abort_connection();
  void send_life_sign(double now);
  void send_tpdos(double now);
  void send_tpdo(const Frame& frame, double now);
  void send(const Frame& frame, double due);
  void report_error(std::uint16_t code, std::uint8_t error_register, double now);
  AbortCode store(std::uint32_t signature);
  [[nodiscard]] std::uint32_t status_word() const;
  [[nodiscard]] std::uint32_t position(std::size_t side) const;
  [[nodiscard]] std::uint32_t way() const;
  [[nodiscard]] std::uint32_t speed(std::size_t side) const;
  [[nodiscard]] double ramp(std::uint16_t index) const;

  DriveNodeOptions options_;
  std::array<std::uint32_t, 3> stored_;
  std::optional<std::uint32_t> stored_feed_;
  ObjectDictionary dictionary_;
  std::unique_ptr<SdoServer> sdo_;
  std::deque<TransmitPdo> tpdos_;
  std::deque<ReceivePdo> rpdos_;
  DriveStateMachine machine_;
  NmtState nmt_ = NmtState::booting;
  std::deque<Outgoing> outgoing_;
  std::map<std::uint32_t, Frame> held_back_;  // by identifier, while TPDOs are reordered
  WheelState wheels_;
  std::array<std::int64_t, 2> zero_{};
  double now_ = 0.0, boot_at_ = 0.0, last_life_sign_ = 0.0;
  std::optional<double> master_seen_;
  unsigned store_count_ = 0;
  bool connection_lost_ = false;
};

}  // namespace odomcalib::sim
