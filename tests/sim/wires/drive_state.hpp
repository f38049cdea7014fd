// The CiA 402 state machine of a drive with one control word for both axes.
#pragma once

#include <cstdint>

namespace odomcalib::sim {

enum class DriveState {
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// Action of the power stage on the motors.
enum class MotorAction {
  free,        ///< no torque
  follow,      ///< target velocity with the profile ramps
  halt,        ///< to rest with the profile ramp
  quick_stop,  ///< to rest with the quick-stop ramp
};

/// Option codes 605Ah, 605Bh, 605Ch, 605Eh.
struct StopOptions {
  int quick_stop =
      6;  ///< 0 coast, 1 ramp, 2 quick ramp, then disabled; 5, 6, 7 the same but stay in quick stop
  int shutdown = 1;           ///< 0 coast, 1 ramp
  int disable_operation = 1;  ///< 0 coast, 1 ramp
  int fault_reaction = 2;     ///< 0 coast, 1 ramp, 2 quick ramp
};

class DriveStateMachine {
 public:
  void control(std::uint16_t word);
  void fault();
  /// As after power-on.
  void reset();
  /// Quick stop without a control word, e.g. on loss of the master.
  void quick_stop();
  void disable_voltage();
  /// Call regularly: finishes stops. @param at_rest both wheels stand still
  void update(bool at_rest);

  [[nodiscard]] DriveState state() const { return state_; }
  [[nodiscard]] MotorAction action() const;
  [[nodiscard]] bool enabled() const;
  /// Bits 0 to 6 of the status word.
  [[nodiscard]] std::uint16_t status_bits() const;
  /// True once after a fault was reset by the master.
  bool take_fault_reset();
  StopOptions options;

 private:
  void leave_operation(DriveState next, int option);

  DriveState state_ = DriveState::switch_on_disabled;
  MotorAction stopping_ = MotorAction::free;  ///< ramp that goes on although the state has no torque any more
  std::uint16_t word_ = 0;
  bool fault_was_reset_ = false;
};

}  // namespace odomcalib::sim
