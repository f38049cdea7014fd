// Our end of the test with bindings of another language: one message of every type out, any message in.
//   lcm_messages encode    lines "TYPE HEX" on standard output
//   lcm_messages decode    lines "TYPE HEX" on standard input, each answered by the fields as JSON, or by
//   null
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "proto/wire/messages.hpp"

namespace {

using namespace odomcalib;
using nlohmann::json;

constexpr messages::Stamp kStamp{1'700'000'000'123'456, 987'654'321'012};

std::string scan_bytes() {
  Scan scan;
  scan.angle_min = -1.5;
  scan.angle_increment = 0.25;
  scan.time_increment = 0.0078125;
  scan.range_min = 0.125;
  scan.range_max = 12.0;
  scan.ranges = {1.5F, 0.0F, 2.25F};
  scan.angles = {-1.5F, -1.25F, -0.75F};
  scan.times = {0.0F, 0.5F, 0.625F};
  scan.intensities = {10.0F, 0.0F, 255.0F};
  scan.sensor = "front";
  return messages::encode(kStamp, scan, {42, messages::TimeSource::device_clock, 150}, false);
}

std::map<std::string, std::string> one_of_each() {
  const RobotDescription robot{0.147, 0.146, 0.411, 16384.0, std::array{0.1, -0.02, 0.75}, "robot-1", "sim"};
  return {
      {"robot_t", messages::encode(kStamp.utime, robot)},
      {"ticks_t", messages::encode(kStamp, TickSample{0.0, -5'000'000'000, 70000, 3},
                                   {7, messages::TimeSource::sync_echo, 200})},
      {"scan_t", scan_bytes()},
      {"pose_t", messages::encode(kStamp, PoseSample{0.0, 1.5, -2.25, 3.125})},
      {"gyro_t", messages::encode(kStamp, GyroSample{0.0, -0.625})},
      {"path_t",
       messages::encode_path(kStamp.utime, "odometry", {{0.0, 1.0, 2.0, 0.5}, {1.0, 3.0, 4.0, -0.5}})},
      {"event_t", messages::encode_event(kStamp, messages::Severity::stop, "lease", "not renewed: \xC2\xB5")},
      {"json_t", messages::encode_json(kStamp.utime, "odomcalib-calibration/1", R"({"a":[1,2]})")},
  };
}

json stamped(const messages::Stamp& stamp) { return {{"utime", stamp.utime}, {"mono_ns", stamp.mono_ns}}; }

void add(json& out, const messages::Origin& origin) {
  out["seq"] = origin.seq;
  out["time_source"] = static_cast<int>(origin.time_source);
  out["time_uncertainty_us"] = origin.time_uncertainty_us;
}

json fields(const messages::ScanMessage& message) {
  json out = stamped(message.stamp);
  add(out, message.origin);
  const Scan& scan = message.scan;
  out["sensor"] = scan.sensor;
  out["angle_min"] = scan.angle_min;
  out["angle_increment"] = scan.angle_increment;
  out["time_increment"] = scan.time_increment.value_or(0.0);
  out["range_min"] = scan.range_min;
  out["range_max"] = scan.range_max;
  out["ranges"] = scan.ranges;
  out["angles"] = scan.angles;
  out["times"] = scan.times;
  out["intensities"] = scan.intensities;
  out["complete"] = message.complete ? 1 : 0;
  return out;
}

json fields(const messages::TicksMessage& message) {
  json out = stamped(message.stamp);
  add(out, message.origin);
  out["left"] = message.ticks.left;
  out["right"] = message.ticks.right;
  out["segment"] = message.ticks.segment;
  return out;
}

json fields(const RobotDescription& robot) {
  return {{"left_wheel_diameter", robot.left_wheel_diameter},
          {"right_wheel_diameter", robot.right_wheel_diameter},
          {"track_width", robot.track_width},
          {"ticks_per_rev", robot.ticks_per_rev},
          {"lidar_pose", robot.lidar_pose.value_or(std::array<double, 3>{})},
          {"robot_id", robot.robot_id},
          {"controller", robot.controller}};
}

json fields(const messages::PoseMessage& message) {
  json out = stamped(message.stamp);
  out["x"] = message.pose.x;
  out["y"] = message.pose.y;
  out["yaw"] = message.pose.yaw;
  return out;
}

json fields(const messages::GyroMessage& message) {
  json out = stamped(message.stamp);
  out["yaw_rate"] = message.gyro.yaw_rate;
  return out;
}

json fields(const messages::EventMessage& message) {
  json out = stamped(message.stamp);
  out["severity"] = static_cast<int>(message.severity);
  out["code"] = message.code;
  out["text"] = message.text;
  return out;
}

json fields(const messages::JsonMessage& message) {
  return {{"utime", message.utime}, {"format", message.format}, {"json", message.json}};
}

template <typename Message>
json fields_or_null(const std::optional<Message>& message) {
  return message ? fields(*message) : json();
}

json decoded(const std::string& type, const std::string& bytes) {
  if (type == "robot_t") return fields_or_null(messages::decode_robot(bytes));
  if (type == "ticks_t") return fields_or_null(messages::decode_ticks(bytes));
  if (type == "scan_t") return fields_or_null(messages::decode_scan(bytes));
  if (type == "pose_t") return fields_or_null(messages::decode_pose(bytes));
  if (type == "gyro_t") return fields_or_null(messages::decode_gyro(bytes));
  if (type == "event_t") return fields_or_null(messages::decode_event(bytes));
  if (type == "json_t") return fields_or_null(messages::decode_json(bytes));
  return {};
}

std::string from_hex(const std::string& hex) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    out += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc == 2 ? argv[1] : "";
  if (what == "encode") {
    for (const auto& [type, bytes] : one_of_each()) {
      std::printf("%s ", type.c_str());
      for (const char byte : bytes)
        std::printf("%02x", static_cast<unsigned>(static_cast<unsigned char>(byte)));
      std::printf("\n");
    }
    return 0;
  }
  if (what != "decode") return 2;
  for (std::string type, hex; std::cin >> type >> hex;)
    std::cout << decoded(type, from_hex(hex)).dump() << '\n';
  return 0;
}
