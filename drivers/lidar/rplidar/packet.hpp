// Measurement packets of SLAMTEC RPLIDARs: checksums, and points from packets. A compressed packet
// ("capsule") gives its points only together with the packet after it. Source: SLAMTEC, "RPLIDAR Interface
// Protocol and Application Notes", and rplidar_sdk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/bytes.hpp"
#include "drivers/lidar/rplidar/settings.hpp"

namespace odomcalib::drivers::rplidar {

/// Type byte of the answer descriptor.
enum class PacketType : std::uint8_t {
  standard = 0x81,
  express = 0x82,
  hq = 0x83,
  ultra = 0x84,
  dense = 0x85,
  ultra_dense = 0x86
};

struct PacketFormat {
  PacketType type = PacketType::standard;
  const char* name = "";
  std::size_t bytes = 0;
  unsigned points = 0;
  double sample_s = 0.0;  ///< usual time per point, used until the device tells its own
};

/// nullptr when the type is not a known measurement packet.
const PacketFormat* find_format(unsigned type);

struct Point {
  double clockwise = 0.0;  ///< degrees, 0..360
  double range_mm = 0.0;   ///< 0: no reading
  unsigned quality = 0;
  bool start = false;  ///< a new turn begins with this point
};

/// Check bits of a standard packet fit a random place with probability 1/4: this many in a row do not.

/// Whether the bytes can be such a packet, by its fixed bits alone. Never asks for more bytes than are there.
bool may_begin(PacketType type, Bytes rest);
/// Whether checksum or check bits of a whole packet are right.
bool is_intact(PacketType type, Bytes packet);

/// Capsules only (all but standard and hq): direction of the first point, degrees clockwise.
double start_angle(PacketType type, Bytes capsule);
/// Capsules only: the device has begun measuring anew, so the capsule before has no successor.
bool begins_run(PacketType type, Bytes capsule);
bool is_capsule(PacketType type);

/// Points of a capsule.
/// @param next the capsule after it (its first value belongs to the last points in ultra mode)
/// @param span degrees from its first point to the first of the next capsule
std::vector<Point> capsule_points(PacketType type, Bytes capsule, Bytes next, double span);
/// Points of a standard or hq packet, which carry their own angles.
std::vector<Point> own_points(PacketType type, Bytes packet);

}  // namespace odomcalib::drivers::rplidar
