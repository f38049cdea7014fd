#include "drivers/base/cia402/drive_state.hpp"

#include <algorithm>

namespace odomcalib::drivers::canopen {
namespace {

/// How far an axis is from torque: smaller is further back.
int rank(DriveState state) {
  switch (state) {
    case DriveState::fault_reaction:
      return 0;
    case DriveState::fault:
      return 1;
    case DriveState::not_ready:
      return 2;
    case DriveState::quick_stop_active:
      return 3;
    case DriveState::switch_on_disabled:
      return 4;
    case DriveState::ready:
      return 5;
    case DriveState::switched_on:
      return 6;
    case DriveState::enabled:
      return 7;
  }
  return 0;
}

std::uint16_t word_from(DriveState state, bool reset_edge) {
  switch (state) {
    case DriveState::fault:
      return reset_edge ? kFaultReset : kDisableVoltage;
    case DriveState::switch_on_disabled:
      return kShutdown;
    case DriveState::ready:
      return kSwitchOn;
    case DriveState::switched_on:
    case DriveState::enabled:
      return kEnableOperation;
    case DriveState::not_ready:
    case DriveState::fault_reaction:
    case DriveState::quick_stop_active:
      return kDisableVoltage;
  }
  return kDisableVoltage;
}

}  // namespace

DriveState decode_status(std::uint16_t status_word) {
  switch (status_word & 0x004F) {
    case 0x0000:
      return DriveState::not_ready;
    case 0x0040:
      return DriveState::switch_on_disabled;
    case 0x000F:
      return DriveState::fault_reaction;
    case 0x0008:
      return DriveState::fault;
    default:
      break;
  }
  switch (status_word & 0x006F) {
    case 0x0021:
      return DriveState::ready;
    case 0x0023:
      return DriveState::switched_on;
    case 0x0027:
      return DriveState::enabled;
    case 0x0007:
      return DriveState::quick_stop_active;
    default:
      return DriveState::not_ready;
  }
}

std::string to_text(DriveState state) {
  switch (state) {
    case DriveState::not_ready:
      return "not ready to switch on";
    case DriveState::switch_on_disabled:
      return "switch-on disabled";
    case DriveState::ready:
      return "ready to switch on";
    case DriveState::switched_on:
      return "switched on";
    case DriveState::enabled:
      return "operation enabled";
    case DriveState::quick_stop_active:
      return "quick stop active";
    case DriveState::fault_reaction:
      return "fault reaction active";
    case DriveState::fault:
      return "fault";
  }
  return "unknown";
}

std::uint16_t control_word_towards_enabled(DriveState left, DriveState right, bool reset_edge) {
  return word_from(rank(left) <= rank(right) ? left : right, reset_edge);
}

}  // namespace odomcalib::drivers::canopen
