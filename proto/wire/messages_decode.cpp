#include <cmath>

#include "proto/wire/lcm_fields.hpp"
#include "proto/wire/messages.hpp"

namespace odomcalib::messages {
namespace {

/// A reader behind the fingerprint; failed when it is another one.
ByteReader open(std::string_view bytes, std::uint64_t expected) {
  ByteReader reader(bytes);
  if (reader.big_endian<std::uint64_t>() != expected) reader.fail();
  return reader;
}

Stamp read_stamp(ByteReader& reader) {
  const auto utime = reader.big_endian<std::int64_t>();
  return {utime, reader.big_endian<std::int64_t>()};
}

std::vector<float> read_floats(ByteReader& reader) {
  const auto count = reader.big_endian<std::int32_t>();
  return lcm_array<float>(reader, count);
}

double read_float(ByteReader& reader) { return static_cast<double>(reader.big_endian<float>()); }

TimeSource read_time_source(ByteReader& reader) {
  const auto value = reader.big_endian<std::int8_t>();
  if (value < 0 || value > static_cast<std::int8_t>(TimeSource::request_midpoint)) return TimeSource::arrival;
  return static_cast<TimeSource>(value);
}

/// Only a message that was read to its last byte is whole.
template <typename Message>
std::optional<Message> whole(const ByteReader& reader, Message message) {
  if (!reader.at_end()) return std::nullopt;
  return message;
}

/// "KIND [ID]", or of earlier versions and other programs the kind alone.
void take_controller(const std::string& text, RobotDescription& robot) {
  const std::size_t at = text.ends_with(']') ? text.rfind(" [") : std::string::npos;
  robot.controller = text.substr(0, at);
  if (at != std::string::npos) robot.controller_id = text.substr(at + 2, text.size() - at - 3);
}

}  // namespace

std::optional<std::uint64_t> fingerprint(std::string_view bytes) {
  ByteReader reader(bytes);
  const auto value = reader.big_endian<std::uint64_t>();
  return reader.ok() ? std::optional(value) : std::nullopt;
}

std::optional<RobotDescription> decode_robot(std::string_view bytes) {
  auto reader = open(bytes, kRobotFingerprint);
  reader.big_endian<std::int64_t>();  // utime
  RobotDescription out;
  out.robot_id = lcm_text(reader);
  take_controller(lcm_text(reader), out);
  out.left_wheel_diameter = reader.big_endian<double>();
  out.right_wheel_diameter = reader.big_endian<double>();
  out.track_width = reader.big_endian<double>();
  out.ticks_per_rev = reader.big_endian<double>();
  const bool has_pose = reader.big_endian<std::int8_t>() != 0;
  std::array<double, 3> pose{};
  for (double& value : pose) value = reader.big_endian<double>();
  if (has_pose && std::isfinite(pose[0] + pose[1] + pose[2])) out.lidar_pose = pose;
  return whole(reader, std::move(out));
}

std::optional<TicksMessage> decode_ticks(std::string_view bytes) {
  auto reader = open(bytes, kTicksFingerprint);
  TicksMessage out;
  out.stamp = read_stamp(reader);
  out.origin.seq = reader.big_endian<std::int32_t>();
  out.ticks.segment = reader.big_endian<std::int32_t>();
  out.ticks.left = reader.big_endian<std::int64_t>();
  out.ticks.right = reader.big_endian<std::int64_t>();
  out.origin.time_source = read_time_source(reader);
  out.origin.time_uncertainty_us = reader.big_endian<std::int32_t>();
  out.ticks.t = seconds(out.stamp);
  return whole(reader, out);
}

std::optional<ScanMessage> decode_scan(std::string_view bytes) {
  auto reader = open(bytes, kScanFingerprint);
  ScanMessage out;
  out.stamp = read_stamp(reader);
  out.origin.seq = reader.big_endian<std::int32_t>();
  out.scan.sensor = lcm_text(reader);
  out.scan.angle_min = read_float(reader);
  out.scan.angle_increment = read_float(reader);
  const double time_increment = read_float(reader);
  if (time_increment != 0.0) out.scan.time_increment = time_increment;
  out.scan.range_min = read_float(reader);
  out.scan.range_max = read_float(reader);
  out.scan.ranges = read_floats(reader);
  out.scan.angles = read_floats(reader);
  out.scan.times = read_floats(reader);
  out.scan.intensities = read_floats(reader);
  out.complete = reader.big_endian<std::int8_t>() != 0;
  out.origin.time_source = read_time_source(reader);
  out.origin.time_uncertainty_us = reader.big_endian<std::int32_t>();
  out.scan.t = seconds(out.stamp);
  return whole(reader, std::move(out));
}

std::optional<PoseMessage> decode_pose(std::string_view bytes) {
  auto reader = open(bytes, kPoseFingerprint);
  PoseMessage out;
  out.stamp = read_stamp(reader);
  out.pose.t = seconds(out.stamp);
  out.pose.x = reader.big_endian<double>();
  out.pose.y = reader.big_endian<double>();
  out.pose.yaw = reader.big_endian<double>();
  return whole(reader, out);
}

std::optional<GyroMessage> decode_gyro(std::string_view bytes) {
  auto reader = open(bytes, kGyroFingerprint);
  GyroMessage out;
  out.stamp = read_stamp(reader);
  out.gyro.t = seconds(out.stamp);
  out.gyro.yaw_rate = reader.big_endian<double>();
  return whole(reader, out);
}

std::optional<EventMessage> decode_event(std::string_view bytes) {
  auto reader = open(bytes, kEventFingerprint);
  EventMessage out;
  out.stamp = read_stamp(reader);
  const auto severity = reader.big_endian<std::int8_t>();
  if (severity < 0 || severity > static_cast<std::int8_t>(Severity::fault)) reader.fail();
  out.severity = static_cast<Severity>(severity);
  out.code = lcm_text(reader);
  out.text = lcm_text(reader);
  return whole(reader, std::move(out));
}

std::optional<JsonMessage> decode_json(std::string_view bytes) {
  auto reader = open(bytes, kJsonFingerprint);
  JsonMessage out;
  out.utime = reader.big_endian<std::int64_t>();
  out.format = lcm_text(reader);
  out.json = lcm_text(reader);
  return whole(reader, std::move(out));
}

}  // namespace odomcalib::messages
