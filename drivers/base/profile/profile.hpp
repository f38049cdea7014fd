// A controller profile: everything that differs between controllers of one protocol, read from TOML
// (docs/user/profiles.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/canopen/object.hpp"
#include "drivers/base/canopen/pdo.hpp"
#include "drivers/base/profile/settings.hpp"
#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

/// An object that is set to a fixed value.
struct ProfileWrite {
  canopen::ObjectAddress object;
  canopen::NumberType type;
  std::int64_t value = 0;
};

struct ProfileWatchdog {
  enum class Kind {
    none,                ///< the drive cannot watch this program: it will not be enabled
    builtin,             ///< the device has a fixed command time-out of time_ms
    heartbeat_consumer,  ///< 1016h watches our heartbeat
    object               ///< a vendor object holds a command time-out
  } kind = Kind::none;
  canopen::ObjectAddress object;
  canopen::NumberType type{2, false};
  double unit_ms = 1.0;
  double time_ms = 200.0;
  std::vector<ProfileWrite> also;  ///< e.g. 6007h: what the drive does when it no longer hears us
};

struct ProfileParameter {
  std::string quantity;  ///< left_wheel_diameter, right_wheel_diameter, track_width
  canopen::ObjectAddress object;
  canopen::NumberType type;
  double scale = 1.0;  ///< SI = raw * scale
  bool feed = false;   ///< raw * scale = pi * diameter * turns (factor group 6092h)
  double turns = 1.0;
  std::int64_t min = 0, max = 0;  ///< accepted raw values

  [[nodiscard]] double to_si(std::int64_t raw) const;
  /// Nearest raw value; nullopt when the value is not finite or out of min..max.
  [[nodiscard]] std::optional<std::int64_t> to_raw(double si) const;
  [[nodiscard]] double step() const { return to_si(1) - to_si(0); }
};

struct ProfileStore {
  canopen::ObjectAddress object;
  canopen::NumberType type;
  std::int64_t value = 0;
  double wait_s = 5.0;
  bool verify_after_reset = false;  ///< reset the node after the store and read again
};

struct Profile {
  std::string name;
  std::string protocol = "canopen";
  std::uint8_t node = 1;  ///< CANopen: of the drive; VESC: our own
  unsigned bitrate = 500'000;
  std::uint32_t vendor = 0, product = 0;  ///< 0: not compared
  // Life signs
  std::uint16_t heartbeat_ms = 30;  ///< of the drive
  double heartbeat_unit_ms = 1.0;   ///< of 1017h
  std::uint8_t host_node = 0x7F;
  ProfileWatchdog watchdog;
  std::vector<ProfileWrite> init;  ///< written after the identity was checked
  // Objects in process data
  canopen::ObjectAddress position_left, position_right, status, control, speed_left, speed_right;
  std::optional<canopen::ObjectAddress> fault;
  std::optional<ProfileWrite> mode;  ///< 6060h
  canopen::ObjectAddress mode_display;
  std::vector<canopen::Pdo> pdos;
  double sync_period_s = 0.0;  ///< of the SYNC we send; 0: none
  int axes = 2;                ///< 1: one side of a pair, whose objects are position_left, speed_left
  std::string side;            ///< "left" or "right": the side of a pair that this is
  /// A pair of single-axis drives: the left and the right one. Empty otherwise.
  std::vector<Profile> sides;
  // Units
  double ticks_per_rev = 0.0;
  int left_sign = 1, right_sign = 1;  ///< -1: the motor is mounted mirrored
  double rpm_per_count = 1.0;         ///< unit of the speed command
  double max_rpm = 0.0;
  std::vector<ProfileParameter> parameters;
  std::optional<ProfileStore> store;
  // Protocols other than CANopen
  std::uint8_t left_node = 1, right_node = 2;  ///< ids of the two devices, or numbers of the two motors
  std::string count_source;                    ///< which message holds the counts, where there are several
  unsigned count_bits = 32;                    ///< width of the counter
  double counts_live_s = 0.5;                  ///< without counts for so long, the controller is gone
  double motor_turns_per_rev = 1.0;            ///< gear
  double interval_s = 0.0;  ///< of the device's control loop, where speeds are counts in it
  RobotDescription robot;   ///< nominal geometry, zeros where the profile states none
};

/// Errors: io, format (which key, what was found, what is allowed).
Result<Profile> read_profile(const std::string& path);
Result<Profile> parse_profile(const std::string& toml, const std::string& where);

}  // namespace odomcalib::drivers
