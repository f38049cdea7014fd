// A robot's drive as ROS would have recorded it: messages by topic, encoded for ROS 1 or ROS 2. Written from
// the message definitions alone; shares no code with the readers in proto/.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::sim {

/// How messages are encoded: ROS 1, or ROS 2 (CDR) in either byte order, in the older or the newer CDR.
enum class Wire { ros1, cdr_little, cdr_big, cdr2_little, cdr2_big };

struct RosTopic {
  std::string name;
  std::string type;  ///< as ROS 1 writes it; in MCAP it may be empty: the channel has no schema then
};

struct RosMessage {
  std::size_t topic = 0;
  std::int64_t received_ns = 0;
  std::string bytes;
};

struct RosLog {
  Wire wire = Wire::ros1;
  std::vector<RosTopic> topics;
  std::vector<RosMessage> messages;  ///< in the order of reception

  [[nodiscard]] std::size_t topic(const std::string& name, const std::string& type);  ///< adds it when new
  void add(const std::string& name, const std::string& type, std::int64_t received_ns, std::string bytes);
};

/// sensor_msgs/LaserScan -> sensor_msgs/msg/LaserScan
std::string ros2_type(const std::string& type);
/// Text of the definition with all that it contains, as rosbag and MCAP store it.
std::string definition_of(const std::string& type, Wire wire);
/// MD5 of the ROS 1 definition; empty for types that are not known here.
std::string md5_of(const std::string& type);

// ---- messages

struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

std::string encode_scan(Wire wire, const RosHeader& header, const Scan& scan);
std::string encode_joints(Wire wire, const RosHeader& header, const std::vector<std::string>& names,
                          const std::vector<double>& positions, const std::vector<double>& velocities);
/// @param yaw_rate rad/s; the other axes get something else
std::string encode_imu(Wire wire, const RosHeader& header, double yaw_rate, double first_covariance = 0.0);
std::string encode_odometry(Wire wire, const RosHeader& header, const std::string& child,
                            const std::array<double, 3>& pose);
std::string encode_pose(Wire wire, const RosHeader& header, const std::array<double, 3>& pose);
/// One transform of tf2_msgs/TFMessage, from the frame of the header.
struct RosTransform {
  RosHeader header;
  std::string child;
  std::array<double, 3> position{};              ///< m
  std::array<double, 4> quaternion{0, 0, 0, 1};  ///< x, y, z, w
};
std::string encode_transforms(Wire wire, const std::vector<RosTransform>& transforms);
/// std_msgs/String.
std::string encode_text(Wire wire, const std::string& text);

// ---- a whole drive

struct RosDrive {
  Wire wire = Wire::ros1;
  bool joints = true;    ///< /joint_states, with the wheels among other joints
  bool odometry = true;  ///< /odom, integrated from the ticks with the nominal values
  std::int64_t start_ns = 1'700'000'000'000'000'000;  ///< of the recording's clock
  std::int64_t latency_ns = 3'000'000;                ///< from stamp to reception
};

/// /scan, /joint_states, /odom, /imu (where the recording has a gyro), /rosout of a recording with ticks.
RosLog ros_log(const Recording& recording, const RosDrive& drive);

}  // namespace odomcalib::sim
