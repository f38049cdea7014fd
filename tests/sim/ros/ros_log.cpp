#include "tests/sim/ros/ros_log.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <utility>

namespace odomcalib::sim {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// ---- definitions (comments left out), of ROS 1; those of ROS 2 differ in the header

const std::map<std::string, std::string>& definitions() {
  static const std::map<std::string, std::string> kAll{
      {"std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n"},
      {"std_msgs/String", "string data\n"},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
      {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
      {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
      {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
      {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
      {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
      {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
      {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
      {"nav_msgs/Odometry",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist\n"},
      {"sensor_msgs/LaserScan",
       "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
       "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
       "float32[] intensities\n"},
      {"sensor_msgs/JointState",
       "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"},
      {"sensor_msgs/Imu",
       "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
       "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
       "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
  };
  return kAll;
}

std::string own_definition(const std::string& type, Wire wire) {
  if (wire != Wire::ros1 && type == "std_msgs/Header")
    return "builtin_interfaces/Time stamp\nstring frame_id\n";
  if (type == "builtin_interfaces/Time") return "int32 sec\nuint32 nanosec\n";
  const auto found = definitions().find(type);
  return found == definitions().end() ? "" : found->second;
}

/// Types that a type contains, each once, in the order of a walk through them.
void collect_parts(const std::string& type, Wire wire, std::vector<std::string>& parts) {
  std::istringstream lines(own_definition(type, wire));
  for (std::string part, name; lines >> part >> name;)
    if (part.find('/') != std::string::npos && std::find(parts.begin(), parts.end(), part) == parts.end()) {
      parts.push_back(part);
      collect_parts(part, wire, parts);
    }
}

// ---- bytes

/// Appends numbers as ROS 1 or CDR has them.
class Encoder {
 public:
  explicit Encoder(Wire wire) : wire_(wire) {
    const char representation = wire == Wire::cdr_big      ? 0
                                : wire == Wire::cdr_little ? 1
                                : wire == Wire::cdr2_big   ? 6
                                                           : 7;
    if (is_cdr()) bytes_ = {0, representation, 0, 0};
  }

  template <typename Number>
  Encoder& number(Number value) {
    align(sizeof(Number));
    auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    const bool big = wire_ == Wire::cdr_big || wire_ == Wire::cdr2_big;
    if (big != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  Encoder& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + (is_cdr() ? 1 : 0)));
    bytes_ += value;
    if (is_cdr()) bytes_ += '\0';
    return *this;
  }
  template <typename Number>
  Encoder& sequence(const std::vector<Number>& values) {
    number(static_cast<std::uint32_t>(values.size()));
    for (const Number value : values) number(value);
    return *this;
  }
  Encoder& repeated(double value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) number(value);
    return *this;
  }
  Encoder& header(const RosHeader& header) {
    if (!is_cdr()) number(std::uint32_t{42});
    number(static_cast<std::uint32_t>(header.stamp_ns / kSecond));
    number(static_cast<std::uint32_t>(header.stamp_ns % kSecond));
    return text(header.frame);
  }
  Encoder& pose(const std::array<double, 3>& pose) {
    number(pose[0]).number(pose[1]).number(0.01);
    return number(0.0).number(0.0).number(std::sin(pose[2] / 2.0)).number(std::cos(pose[2] / 2.0));
  }
  std::string take() { return std::move(bytes_); }

 private:
  [[nodiscard]] bool is_cdr() const { return wire_ != Wire::ros1; }
  void align(std::size_t size) {
    if (!is_cdr()) return;
    const bool newer = wire_ == Wire::cdr2_little || wire_ == Wire::cdr2_big;
    const std::size_t step = newer ? std::min<std::size_t>(size, 4) : size;
    while ((bytes_.size() - 4) % step != 0) bytes_ += '\0';
  }

  Wire wire_;
  std::string bytes_;
};

float range_or_none(float range) { return range == 0.0F ? std::numeric_limits<float>::infinity() : range; }

// ---- a drive

std::int64_t stamp_of(const RosDrive& drive, double t) { return drive.start_ns + std::llround(t * 1e9); }

void add_joints(RosLog& log, const Recording& recording, const RosDrive& drive) {
  const double rad = 2.0 * std::numbers::pi / recording.robot.ticks_per_rev;
  for (const TickSample& sample : recording.ticks) {
    const std::int64_t stamp = stamp_of(drive, sample.t);
    log.add("/joint_states", "sensor_msgs/JointState", stamp + drive.latency_ns,
            encode_joints(
                drive.wire, {stamp, ""}, {"lift_joint", "wheel_right_joint", "wheel_left_joint"},
                {0.1, rad * static_cast<double>(sample.right), rad * static_cast<double>(sample.left)}, {}));
  }
}

void add_odometry(RosLog& log, const Recording& recording, const RosDrive& drive) {
  const RobotDescription& robot = recording.robot;
  std::array<double, 3> pose{};
  const TickSample* last = nullptr;
  for (const TickSample& sample : recording.ticks) {
    if (last != nullptr) {
      const double turn = std::numbers::pi / robot.ticks_per_rev;
      const double left = turn * robot.left_wheel_diameter * static_cast<double>(sample.left - last->left);
      const double right =
          turn * robot.right_wheel_diameter * static_cast<double>(sample.right - last->right);
      const double yaw = (right - left) / robot.track_width;
      pose[0] += 0.5 * (left + right) * std::cos(pose[2] + 0.5 * yaw);
      pose[1] += 0.5 * (left + right) * std::sin(pose[2] + 0.5 * yaw);
      pose[2] += yaw;
    }
    last = &sample;
    const std::int64_t stamp = stamp_of(drive, sample.t);
    log.add("/odom", "nav_msgs/Odometry", stamp + drive.latency_ns,
            encode_odometry(drive.wire, {stamp, "odom"}, "base_link", pose));
  }
}

void add_scans(RosLog& log, const Recording& recording, const RosDrive& drive) {
  for (const Scan& scan : recording.scans) {
    const std::int64_t stamp = stamp_of(drive, scan.t);
    const double length = scan.time_increment.value_or(0.0) * static_cast<double>(scan.ranges.size());
    log.add("/scan", "sensor_msgs/LaserScan", stamp + drive.latency_ns + std::llround(length * 1e9),
            encode_scan(drive.wire, {stamp, "laser"}, scan));
  }
}

void add_gyro(RosLog& log, const Recording& recording, const RosDrive& drive) {
  for (const GyroSample& sample : recording.gyro) {
    const std::int64_t stamp = stamp_of(drive, sample.t);
    log.add("/imu", "sensor_msgs/Imu", stamp + drive.latency_ns,
            encode_imu(drive.wire, {stamp, "imu"}, sample.yaw_rate));
  }
}

}  // namespace

std::size_t RosLog::topic(const std::string& name, const std::string& type) {
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].name == name && topics[i].type == type) return i;
  topics.push_back({name, type});
  return topics.size() - 1;
}

void RosLog::add(const std::string& name, const std::string& type, std::int64_t received_ns,
                 std::string bytes) {
  messages.push_back({topic(name, type), received_ns, std::move(bytes)});
}

std::string ros2_type(const std::string& type) {
  const auto slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

std::string definition_of(const std::string& type, Wire wire) {
  std::vector<std::string> parts;
  collect_parts(type, wire, parts);
  std::string out = own_definition(type, wire);
  for (const auto& part : parts)
    out += std::string(80, '=') + "\nMSG: " + part + "\n" + own_definition(part, wire);
  return out;
}

std::string md5_of(const std::string& type) {
  static const std::map<std::string, std::string> kSums{
      {"std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"},
      {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"},
      {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"},
      {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2"},
      {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"},
      {"geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"},
      {"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"},
  };
  const auto found = kSums.find(type);
  return found == kSums.end() ? "" : found->second;
}

std::string encode_scan(Wire wire, const RosHeader& header, const Scan& scan) {
  std::vector<float> ranges = scan.ranges;
  std::transform(ranges.begin(), ranges.end(), ranges.begin(), range_or_none);
  const auto beams = static_cast<double>(ranges.size());
  const double step = scan.time_increment.value_or(0.0);
  Encoder out(wire);
  out.header(header);
  for (const double value : {scan.angle_min, scan.angle_min + (beams - 1.0) * scan.angle_increment,
                             scan.angle_increment, step, step * beams, scan.range_min, scan.range_max})
    out.number(static_cast<float>(value));
  return out.sequence(ranges).sequence(scan.intensities).take();
}

std::string encode_joints(Wire wire, const RosHeader& header, const std::vector<std::string>& names,
                          const std::vector<double>& positions, const std::vector<double>& velocities) {
  Encoder out(wire);
  out.header(header).number(static_cast<std::uint32_t>(names.size()));
  for (const auto& name : names) out.text(name);
  return out.sequence(positions).sequence(velocities).sequence(std::vector<double>{}).take();
}

std::string encode_imu(Wire wire, const RosHeader& header, double yaw_rate, double first_covariance) {
  Encoder out(wire);
  out.header(header).number(0.0).number(0.0).number(0.0).number(1.0).repeated(0.1, 9);
  out.number(0.25).number(-0.5).number(yaw_rate).number(first_covariance).repeated(0.0, 8);
  return out.number(0.0).number(0.0).number(9.81).repeated(0.0, 9).take();
}

std::string encode_odometry(Wire wire, const RosHeader& header, const std::string& child,
                            const std::array<double, 3>& pose) {
  return Encoder(wire)
      .header(header)
      .text(child)
      .pose(pose)
      .repeated(0.0, 36)
      .repeated(0.0, 6)
      .repeated(0.0, 36)
      .take();
}

std::string encode_pose(Wire wire, const RosHeader& header, const std::array<double, 3>& pose) {
  return Encoder(wire).header(header).pose(pose).take();
}

std::string encode_transforms(Wire wire, const std::vector<RosTransform>& transforms) {
  Encoder out(wire);
  out.number(static_cast<std::uint32_t>(transforms.size()));
  for (const RosTransform& one : transforms) {
    out.header(one.header).text(one.child);
    for (const double value : one.position) out.number(value);
    for (const double value : one.quaternion) out.number(value);
  }
  return out.take();
}

std::string encode_text(Wire wire, const std::string& text) { return Encoder(wire).text(text).take(); }

RosLog ros_log(const Recording& recording, const RosDrive& drive) {
  RosLog log;
  log.wire = drive.wire;
  if (drive.joints) add_joints(log, recording, drive);
  if (drive.odometry) add_odometry(log, recording, drive);
  add_scans(log, recording, drive);
  add_gyro(log, recording, drive);
  log.add("/rosout", "std_msgs/String", drive.start_ns, Encoder(drive.wire).text("started").take());
  std::stable_sort(log.messages.begin(), log.messages.end(),
                   [](const RosMessage& a, const RosMessage& b) { return a.received_ns < b.received_ns; });
  return log;
}

}  // namespace odomcalib::sim
