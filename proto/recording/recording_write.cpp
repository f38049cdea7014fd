// JSON Lines out: every number in the shortest form that reads back as the same number.
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib {
namespace {

template <typename Number>
void append_shortest(std::string& out, Number value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out.append(text.data(), end);
}

void append_value(std::string& out, double value) {
  if (std::isfinite(value))
    append_shortest(out, value);
  else
    out += "null";
}

/// A reader takes the text as double and rounds to float: where that is not the same float, write all digits.
void append_value(std::string& out, float value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double back = 0.0;
  std::from_chars(text.data(), end, back);
  if (static_cast<float>(back) == value)
    out.append(text.data(), end);
  else
    append_shortest(out, static_cast<double>(value));
}

template <typename Number>
void append_member(std::string& out, const char* name, Number value) {
  out += ",\"";
  out += name;
  out += "\":";
  if constexpr (std::is_integral_v<Number>)
    append_shortest(out, value);
  else
    append_value(out, value);
}

void append_text(std::string& out, const char* name, const std::string& value) {
  if (value.empty()) return;
  using nlohmann::json;
  out += std::string(",\"") + name + "\":" + json(value).dump(-1, ' ', false, json::error_handler_t::replace);
}

enum class Zero { number, null };

void append_array(std::string& out, const char* name, const std::vector<float>& values, Zero zero) {
  out += ",\"";
  out += name;
  out += "\":[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ',';
    if (values[i] == 0.0F && zero == Zero::null)
      out += "null";
    else
      append_value(out, values[i]);
  }
  out += ']';
}

void append_robot(std::string& out, const RobotDescription& robot, double time_zero) {
  out += R"({"type":"robot")";
  if (robot.left_wheel_diameter == robot.right_wheel_diameter) {
    append_member(out, "wheel_diameter", robot.left_wheel_diameter);
  } else {
    append_member(out, "left_wheel_diameter", robot.left_wheel_diameter);
    append_member(out, "right_wheel_diameter", robot.right_wheel_diameter);
  }
  append_member(out, "track_width", robot.track_width);
  append_member(out, "ticks_per_rev", robot.ticks_per_rev);
  if (robot.lidar_pose) {
    const auto& pose = *robot.lidar_pose;
    out += ",\"lidar_pose\":[";
    append_value(out, pose[0]);
    out += ',';
    append_value(out, pose[1]);
    out += ',';
    append_value(out, pose[2]);
    out += ']';
  }
  if (time_zero != 0.0) append_member(out, "time_zero", time_zero);
  append_text(out, "robot_id", robot.robot_id);
  append_text(out, "controller", robot.controller);
  append_text(out, "controller_id", robot.controller_id);
  out += "}\n";
}

void append_line(std::string& out, const TickSample& sample) {
  out += R"({"type":"ticks")";
  append_member(out, "t", sample.t);
  append_member(out, "left", sample.left);
  append_member(out, "right", sample.right);
  if (sample.segment != 0) append_member(out, "segment", sample.segment);
  out += "}\n";
}

void append_line(std::string& out, const Scan& scan) {
  out += R"({"type":"scan")";
  append_member(out, "t", scan.t);
  append_text(out, "sensor", scan.sensor);
  append_member(out, "angle_min", scan.angle_min);
  append_member(out, "angle_increment", scan.angle_increment);
  if (scan.time_increment) append_member(out, "time_increment", *scan.time_increment);
  append_member(out, "range_min", scan.range_min);
  append_member(out, "range_max", scan.range_max);
  append_array(out, "ranges", scan.ranges, Zero::null);
  if (!scan.angles.empty()) append_array(out, "angles", scan.angles, Zero::number);
  if (!scan.times.empty()) append_array(out, "times", scan.times, Zero::number);
  if (!scan.intensities.empty()) append_array(out, "intensities", scan.intensities, Zero::number);
  out += "}\n";
}

void append_wheels(std::string& out, const char* type, const WheelSample& sample) {
  out += std::string("{\"type\":\"") + type + '"';
  append_member(out, "t", sample.t);
  append_member(out, "left", sample.left);
  append_member(out, "right", sample.right);
  out += "}\n";
}

void append_pose(std::string& out, const char* type, const PoseSample& sample) {
  out += std::string("{\"type\":\"") + type + '"';
  append_member(out, "t", sample.t);
  append_member(out, "x", sample.x);
  append_member(out, "y", sample.y);
  append_member(out, "yaw", sample.yaw);
  out += "}\n";
}

void append_line(std::string& out, const GyroSample& sample) {
  out += R"({"type":"gyro")";
  append_member(out, "t", sample.t);
  append_member(out, "yaw_rate", sample.yaw_rate);
  out += "}\n";
}

/// Samples of all streams in the order of their stamps: a cut-off file keeps all streams up to the cut.
class Merge {
 public:
  explicit Merge(const Recording& recording) : recording_(recording) {}

  std::string text() {
    std::string out;
    append_robot(out, recording_.robot, recording_.time_zero);
    while (next(out)) {
    }
    return out;
  }

 private:
  template <typename Sample>
  static double time_at(const std::vector<Sample>& samples, std::size_t index) {
    return index < samples.size() ? samples[index].t : HUGE_VAL;
  }
  bool next(std::string& out) {
    const std::array<double, 4> times{motion_time(at_[0]), time_at(recording_.scans, at_[1]),
                                      time_at(recording_.poses, at_[2]), time_at(recording_.gyro, at_[3])};
    const auto first = static_cast<std::size_t>(std::min_element(times.begin(), times.end()) - times.begin());
    if (times.at(first) == HUGE_VAL) return false;
    const std::size_t index = at_.at(first)++;
    if (first == 0) append_motion(out, index);
    if (first == 1) append_line(out, recording_.scans[index]);
    if (first == 2) append_pose(out, "pose", recording_.poses[index]);
    if (first == 3) append_line(out, recording_.gyro[index]);
    return true;
  }
  /// Written as recorded, not as the ticks that were made of it.
  [[nodiscard]] double motion_time(std::size_t index) const {
    switch (recording_.motion) {
      case MotionSource::wheels:
        return time_at(recording_.wheels, index);
      case MotionSource::wheel_speeds:
        return time_at(recording_.wheel_speeds, index);
      case MotionSource::odometry:
        return time_at(recording_.odometry, index);
      case MotionSource::ticks:
        break;
    }
    return time_at(recording_.ticks, index);
  }
  void append_motion(std::string& out, std::size_t index) const {
    const char* type = name_of(recording_.motion);
    switch (recording_.motion) {
      case MotionSource::wheels:
        return append_wheels(out, type, recording_.wheels[index]);
      case MotionSource::wheel_speeds:
        return append_wheels(out, type, recording_.wheel_speeds[index]);
      case MotionSource::odometry:
        return append_pose(out, type, recording_.odometry[index]);
      case MotionSource::ticks:
        return append_line(out, recording_.ticks[index]);
    }
  }

  const Recording& recording_;
  std::array<std::size_t, 4> at_{};
};

}  // namespace

Result<void> write_recording_jsonl(const Recording& recording, const std::filesystem::path& path) {
  std::string text = Merge(recording).text();
  if (path.extension() == ".gz") {
    auto packed = gzip(text);
    if (!packed) return packed.error();
    text = std::move(packed).value();
  }
  return write_output(path, text);
}

}  // namespace odomcalib
