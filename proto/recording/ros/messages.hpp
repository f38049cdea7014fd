// The ROS messages that calibration can use, decoded from their bytes. Internal to proto/.
//
// ROS 1: little-endian, packed, strings and sequences behind a 32-bit count (wiki.ros.org/msg). ROS 2: CDR
// behind four bytes that name the representation (DDS-RTPS 2.5, 10.2.1.2), numbers aligned to their size
// (XCDR1) or to at most four bytes (XCDR2), strings with their terminating zero.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib::ros {

enum class Encoding : std::uint8_t { ros1, cdr };

/// Kinds of messages that can be decoded.
enum class Kind : std::uint8_t { none, scan, joints, imu, odometry, pose, transforms, description };

/// Where things sit on the robot, no samples.
constexpr bool tells_mounting(Kind kind) { return kind == Kind::transforms || kind == Kind::description; }

/// @param type as ROS 1 (sensor_msgs/LaserScan) or ROS 2 (sensor_msgs/msg/LaserScan) writes it
Kind kind_of(std::string_view type);
/// The ROS 1 name of a kind, e.g. sensor_msgs/LaserScan.
const char* type_of(Kind kind);
/// MD5 of the ROS 1 definition that `decode` reads: a type of the same name may have been defined otherwise.
std::string_view md5_of(Kind kind);

/// std_msgs/Header. The time is 0 where a publisher did not set it.
struct Header {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

struct LaserScan {
  Header header;
  Scan scan;  ///< t is not set; NaN and infinities (REP 117) are "no reading"
};

struct JointState {
  Header header;
  std::vector<std::string> names;
  std::vector<double> positions, velocities;  ///< rad, rad/s; one a name; empty where there are fewer or more
};

struct Imu {
  Header header;
  std::optional<double> yaw_rate;  ///< rad/s; nothing when the covariance begins with -1 (no such estimate)
};

/// nav_msgs/Odometry and geometry_msgs/PoseStamped.
struct PoseMessage {
  Header header;
  std::string child_frame;  ///< Odometry only
  double x = 0.0, y = 0.0;  ///< m
  double yaw = 0.0;         ///< rad, of the quaternion; NaN where that is no rotation
  bool moves = false;       ///< the twist says that the robot drives or turns; Odometry only
};

/// One of tf2_msgs/TFMessage: pose of `child` in `frame`.
struct Transform {
  std::string frame, child;
  std::array<double, 3> position{};    ///< m
  std::array<double, 4> quaternion{};  ///< x, y, z, w; of norm 1
};

/// Transforms of one message or description, in its order.
struct Transforms {
  std::vector<Transform> usable;
  std::size_t unusable = 0;  ///< a position that is not finite, or a quaternion that is no rotation
};

// Nothing when the bytes do not hold what the type says.
std::optional<LaserScan> decode_scan(std::string_view bytes, Encoding encoding);
std::optional<JointState> decode_joints(std::string_view bytes, Encoding encoding);
std::optional<Imu> decode_imu(std::string_view bytes, Encoding encoding);
std::optional<PoseMessage> decode_odometry(std::string_view bytes, Encoding encoding);
std::optional<PoseMessage> decode_pose(std::string_view bytes, Encoding encoding);
std::optional<Transforms> decode_transforms(std::string_view bytes, Encoding encoding);
/// std_msgs/String.
std::optional<std::string> decode_text(std::string_view bytes, Encoding encoding);

}  // namespace odomcalib::ros
