#include <cmath>
#include <odomcalib/event_t.hpp>
#include <odomcalib/gyro_t.hpp>
#include <odomcalib/json_t.hpp>
#include <odomcalib/path_t.hpp>
#include <odomcalib/pose_t.hpp>
#include <odomcalib/robot_t.hpp>
#include <odomcalib/scan_t.hpp>
#include <odomcalib/ticks_t.hpp>

#include "proto/wire/messages.hpp"

namespace odomcalib::messages {
namespace {

template <typename Message>
std::string bytes_of(const Message& message) {
  std::string out(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

double finite(double value) { return std::isfinite(value) ? value : 0.0; }

/// Doubles beyond the floats have no meaning in any field of a scan.
float to_float(double value) {
  return std::abs(value) < 1e30 ? static_cast<float>(value) : 0.0F;  // false for NaN
}

std::vector<float> finite(std::vector<float> values) {
  for (float& value : values)
    if (!std::isfinite(value)) value = 0.0F;
  return values;
}

/// The message has one text for both (decode_robot takes them apart).
std::string with_controller_id(const RobotDescription& robot) {
  return robot.controller_id.empty() ? robot.controller : robot.controller + " [" + robot.controller_id + "]";
}

std::string c_text(const std::string& text) { return text.substr(0, text.find('\0')); }

}  // namespace

std::string encode(std::int64_t utime, const RobotDescription& robot) {
  odomcalib::robot_t out{};
  out.utime = utime;
  out.robot_id = c_text(robot.robot_id);
  out.controller = c_text(with_controller_id(robot));
  out.left_wheel_diameter = finite(robot.left_wheel_diameter);
  out.right_wheel_diameter = finite(robot.right_wheel_diameter);
  out.track_width = finite(robot.track_width);
  out.ticks_per_rev = finite(robot.ticks_per_rev);
  out.has_lidar_pose = robot.lidar_pose ? 1 : 0;
  const auto pose = robot.lidar_pose.value_or(std::array<double, 3>{});
  for (std::size_t i = 0; i < 3; ++i) out.lidar_pose[i] = finite(pose.at(i));
  return bytes_of(out);
}

std::string encode(const Stamp& stamp, const TickSample& ticks, const Origin& origin) {
  odomcalib::ticks_t out{};
  out.utime = stamp.utime;
  out.mono_ns = stamp.mono_ns;
  out.seq = origin.seq;
  out.segment = ticks.segment;
  out.left = ticks.left;
  out.right = ticks.right;
  out.time_source = static_cast<std::int8_t>(origin.time_source);
  out.time_uncertainty_us = origin.time_uncertainty_us;
  return bytes_of(out);
}

std::string encode(const Stamp& stamp, const Scan& scan, const Origin& origin, bool complete) {
  odomcalib::scan_t out{};
  out.utime = stamp.utime;
  out.mono_ns = stamp.mono_ns;
  out.seq = origin.seq;
  out.sensor = c_text(scan.sensor);
  out.angle_min = to_float(scan.angle_min);
  out.angle_increment = to_float(scan.angle_increment);
  out.time_increment = to_float(scan.time_increment.value_or(0.0));
  out.range_min = to_float(scan.range_min);
  out.range_max = to_float(scan.range_max);
  out.ranges = finite(scan.ranges);
  out.nranges = static_cast<std::int32_t>(scan.ranges.size());
  out.angles = finite(scan.angles);
  out.nangles = static_cast<std::int32_t>(scan.angles.size());
  out.times = finite(scan.times);
  out.ntimes = static_cast<std::int32_t>(scan.times.size());
  out.intensities = finite(scan.intensities);
  out.nintensities = static_cast<std::int32_t>(scan.intensities.size());
  out.complete = complete ? 1 : 0;
  out.time_source = static_cast<std::int8_t>(origin.time_source);
  out.time_uncertainty_us = origin.time_uncertainty_us;
  return bytes_of(out);
}

std::string encode(const Stamp& stamp, const PoseSample& pose) {
  odomcalib::pose_t out{};
  out.utime = stamp.utime;
  out.mono_ns = stamp.mono_ns;
  out.x = finite(pose.x);
  out.y = finite(pose.y);
  out.yaw = finite(pose.yaw);
  return bytes_of(out);
}

std::string encode(const Stamp& stamp, const GyroSample& gyro) {
  odomcalib::gyro_t out{};
  out.utime = stamp.utime;
  out.mono_ns = stamp.mono_ns;
  out.yaw_rate = finite(gyro.yaw_rate);
  return bytes_of(out);
}

std::string encode_path(std::int64_t utime, const std::string& name, const std::vector<PoseSample>& path) {
  odomcalib::path_t out{};
  out.utime = utime;
  out.name = c_text(name);
  out.n = static_cast<std::int32_t>(path.size());
  for (const auto& pose : path) {
    out.x.push_back(finite(pose.x));
    out.y.push_back(finite(pose.y));
    out.yaw.push_back(finite(pose.yaw));
  }
  return bytes_of(out);
}

std::string encode_event(const Stamp& stamp, Severity severity, const std::string& code,
                         const std::string& text) {
  odomcalib::event_t out{};
  out.utime = stamp.utime;
  out.mono_ns = stamp.mono_ns;
  out.severity = static_cast<std::int8_t>(severity);
  out.code = c_text(code);
  out.text = c_text(text);
  return bytes_of(out);
}

std::string encode_json(std::int64_t utime, const std::string& format, const std::string& json) {
  odomcalib::json_t out{};
  out.utime = utime;
  out.format = c_text(format);
  out.json = c_text(json);
  return bytes_of(out);
}

}  // namespace odomcalib::messages
