#include "tests/sim/wires/drive_state.hpp"

namespace odomcalib::sim {

namespace {

enum class Command { none, shutdown, switch_on, enable_operation, quick_stop, disable_voltage };

Command decode(std::uint16_t word) {
  if ((word & 0x02U) == 0) return Command::disable_voltage;
  if ((word & 0x04U) == 0) return Command::quick_stop;
  if ((word & 0x01U) == 0) return Command::shutdown;
  return (word & 0x08U) != 0 ? Command::enable_operation : Command::switch_on;
}

constexpr std::uint16_t kHalt = 0x0100;
constexpr std::uint16_t kFaultReset = 0x0080;

MotorAction stop_action(int option) {
  if (option == 0) return MotorAction::free;
  return option == 1 || option == 5 ? MotorAction::halt : MotorAction::quick_stop;
}

}  // namespace

void DriveStateMachine::leave_operation(DriveState next, int option) {
  state_ = next;
  stopping_ = stop_action(option);
}

void DriveStateMachine::control(std::uint16_t word) {
  const bool reset_edge = (word & kFaultReset) != 0 && (word_ & kFaultReset) == 0;
  word_ = word;
  const Command command = decode(word);
  switch (state_) {
    case DriveState::fault:
      if (reset_edge) {
        state_ = DriveState::switch_on_disabled;
        fault_was_reset_ = true;
      }
      break;
    case DriveState::fault_reaction_active:
      break;
    case DriveState::switch_on_disabled:
      if (command == Command::shutdown) state_ = DriveState::ready_to_switch_on;
      break;
    case DriveState::ready_to_switch_on:
      if (command == Command::switch_on) state_ = DriveState::switched_on;
      if (command == Command::quick_stop || command == Command::disable_voltage)
        state_ = DriveState::switch_on_disabled;
      break;
    case DriveState::switched_on:
      if (command == Command::enable_operation) state_ = DriveState::operation_enabled;
      if (command == Command::shutdown) state_ = DriveState::ready_to_switch_on;
      if (command == Command::quick_stop || command == Command::disable_voltage)
        state_ = DriveState::switch_on_disabled;
      break;
    case DriveState::operation_enabled:
      if (command == Command::switch_on) leave_operation(DriveState::switched_on, options.disable_operation);
      if (command == Command::shutdown) leave_operation(DriveState::ready_to_switch_on, options.shutdown);
      if (command == Command::quick_stop) quick_stop();
      if (command == Command::disable_voltage) disable_voltage();
      break;
    case DriveState::quick_stop_active:
      if (command == Command::disable_voltage) disable_voltage();
      if (command == Command::enable_operation && options.quick_stop >= 5)
        state_ = DriveState::operation_enabled;
      break;
  }
}

void DriveStateMachine::quick_stop() {
  if (state_ == DriveState::operation_enabled)
    leave_operation(DriveState::quick_stop_active, options.quick_stop);
}

void DriveStateMachine::disable_voltage() {
  if (state_ != DriveState::fault && state_ != DriveState::fault_reaction_active)
    leave_operation(DriveState::switch_on_disabled, 0);
}

void DriveStateMachine::fault() {
  if (state_ != DriveState::fault)
    leave_operation(DriveState::fault_reaction_active, enabled() ? options.fault_reaction : 0);
}

void DriveStateMachine::reset() {
  state_ = DriveState::switch_on_disabled;
  stopping_ = MotorAction::free;
  word_ = 0;
  fault_was_reset_ = false;
}

void DriveStateMachine::update(bool at_rest) {
  const bool finished = at_rest || stopping_ == MotorAction::free;
  if (!finished) return;
  if (state_ == DriveState::fault_reaction_active) state_ = DriveState::fault;
  if (state_ == DriveState::quick_stop_active && options.quick_stop < 5)
    state_ = DriveState::switch_on_disabled;
  if (state_ != DriveState::quick_stop_active) stopping_ = MotorAction::free;  // quick stop goes on holding
}

MotorAction DriveStateMachine::action() const {
  if (state_ != DriveState::operation_enabled) return stopping_;
  return (word_ & kHalt) != 0 ? MotorAction::halt : MotorAction::follow;
}

bool DriveStateMachine::enabled() const {
  return state_ == DriveState::operation_enabled || state_ == DriveState::quick_stop_active;
}

std::uint16_t DriveStateMachine::status_bits() const {
  switch (state_) {
    case DriveState::switch_on_disabled:
      return 0x60;  // as the real drive: bit 5 stays set
    case DriveState::ready_to_switch_on:
      return 0x21;
    case DriveState::switched_on:
      return 0x23;
    case DriveState::operation_enabled:
      return 0x27;
    case DriveState::quick_stop_active:
      return 0x07;
    case DriveState::fault_reaction_active:
      return 0x0F;
    case DriveState::fault:
      break;
  }
  return 0x08;
}

bool DriveStateMachine::take_fault_reset() {
  const bool was = fault_was_reset_;
  fault_was_reset_ = false;
  return was;
}

}  // namespace odomcalib::sim
