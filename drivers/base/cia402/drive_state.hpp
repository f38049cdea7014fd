// The drive state machine of CiA 402: status words to states, and the one control word that leads on.
#pragma once

#include <cstdint>
#include <string>

namespace odomcalib::drivers::canopen {

enum class DriveState {
  not_ready,
  switch_on_disabled,
  ready,
  switched_on,
  enabled,
  quick_stop_active,
  fault_reaction,
  fault,
};

inline constexpr std::uint16_t kDisableVoltage = 0x0000;
inline constexpr std::uint16_t kQuickStop = 0x0002;
inline constexpr std::uint16_t kShutdown = 0x0006;
inline constexpr std::uint16_t kSwitchOn = 0x0007;
inline constexpr std::uint16_t kEnableOperation = 0x000F;
inline constexpr std::uint16_t kFaultReset = 0x0080;

/// Vendor and information bits are masked away.
DriveState decode_status(std::uint16_t status_word);
std::string to_text(DriveState state);

/// Control word for two axes that share it: the axis that is further back decides, a fault comes first.
/// @param reset_edge whether a fault reset shall be raised now (it must alternate with 0 to make an edge)
std::uint16_t control_word_towards_enabled(DriveState left, DriveState right, bool reset_edge);

}  // namespace odomcalib::drivers::canopen
