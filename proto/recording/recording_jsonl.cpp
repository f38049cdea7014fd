#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "proto/recording/recording_readers.hpp"
#include "proto/wire/json_fields.hpp"

namespace odomcalib {
namespace {

float to_float(double value) {
  // A double that no float can hold is not a length or an angle of a lidar.
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())
             ? static_cast<float>(value)
             : std::numeric_limits<float>::quiet_NaN();
}

std::vector<float> to_floats(const std::vector<double>& values) {
  std::vector<float> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), to_float);
  return out;
}

/// [s, us] as in Censi's raw logs.
double split_time(const std::vector<double>& stamp) {
  return stamp.size() == 2 ? stamp[0] + 1e-6 * stamp[1] : std::numeric_limits<double>::quiet_NaN();
}

double time_of(const JsonFields& fields) {
  return fields.has(Scalar::t) ? fields[Scalar::t] : split_time(fields[Array::timestamp]);
}

/// 0 for what is absent; what is present but no number stays NaN and is refused by name later.
double unit_value(const JsonFields& fields, Scalar field) { return fields.has(field) ? fields[field] : 0.0; }

double diameter(const JsonFields& fields, Scalar side) {
  return unit_value(fields, fields.has(side) ? side : Scalar::wheel_diameter);
}

void add_robot(const JsonFields& fields, RecordingBuilder& builder) {
  RobotDescription robot;
  robot.left_wheel_diameter = diameter(fields, Scalar::left_wheel_diameter);
  robot.right_wheel_diameter = diameter(fields, Scalar::right_wheel_diameter);
  robot.track_width = unit_value(fields, Scalar::track_width);
  robot.ticks_per_rev = unit_value(fields, Scalar::ticks_per_rev);
  if (const double zero = unit_value(fields, Scalar::time_zero); std::isfinite(zero))
    builder.count_from(zero);
  robot.robot_id = fields[Text::robot_id];
  robot.controller = fields[Text::controller];
  robot.controller_id = fields[Text::controller_id];
  const auto& pose = fields[Array::lidar_pose];
  if (pose.size() == 3 && std::all_of(pose.begin(), pose.end(), [](double v) { return std::isfinite(v); }))
    robot.lidar_pose = {pose[0], pose[1], pose[2]};
  else if (!pose.empty() || fields.is_of_wrong_type("lidar_pose"))
    builder.discard("robot", "lidar_pose is not three numbers");
  builder.add_robot(std::move(robot));
}

void add_ticks(const JsonFields& fields, double t, RecordingBuilder& builder) {
  const double segment = fields.has(Scalar::segment) ? fields[Scalar::segment] : 0.0;
  if (!(std::abs(segment) < 2e9))
    builder.discard("ticks", "segment is not a number");
  else if (fields.counts[0] && fields.counts[1])
    builder.add_ticks({t, *fields.counts[0], *fields.counts[1], static_cast<std::int32_t>(segment)});
  else
    builder.discard("ticks", "left or right missing or not a whole number");
}

/// Censi's raw logs give the first and the last direction instead of the step.
double grid_step(const JsonFields& fields, std::size_t beams) {
  if (fields.has(Scalar::angle_increment) || beams < 2) return fields[Scalar::angle_increment];
  return (fields[Scalar::angle_max] - fields[Scalar::angle_min]) / static_cast<double>(beams - 1);
}

/// Censi's raw logs say how many beams there are, and which of them measured something.
const char* beam_problem(const JsonFields& fields) {
  const std::size_t beams = fields[Array::ranges].size(), marks = fields[Array::valid].size();
  if (fields.has(Scalar::beams) && fields[Scalar::beams] != static_cast<double>(beams))
    return "nrays does not match ranges";
  return marks != 0 && marks != beams ? "valid does not match ranges" : nullptr;
}

/// Takes the readings away that are marked as none.
void blank_invalid(const std::vector<double>& valid, std::vector<float>& ranges, RecordingBuilder& builder) {
  std::size_t blanked = 0;
  for (std::size_t k = 0; k < valid.size(); ++k) {
    if (valid[k] > 0.0 || ranges[k] == 0.0F || !std::isfinite(ranges[k])) continue;
    ranges[k] = 0.0F;
    ++blanked;
  }
  builder.discard("beam", "marked as not valid", blanked);
}

void add_scan(const JsonFields& fields, RecordingBuilder& builder) {
  if (const char* problem = beam_problem(fields)) return builder.discard("scan", problem);
  Scan scan;
  scan.t = time_of(fields);
  scan.ranges = to_floats(fields[Array::ranges]);
  blank_invalid(fields[Array::valid], scan.ranges, builder);
  scan.angles = to_floats(fields[Array::angles]);
  scan.times = to_floats(fields[Array::times]);
  scan.intensities = to_floats(fields[Array::intensities]);
  scan.angle_min = fields[Scalar::angle_min];
  scan.angle_increment = grid_step(fields, scan.ranges.size());
  if (fields.has(Scalar::time_increment)) scan.time_increment = fields[Scalar::time_increment];
  scan.range_min = fields[Scalar::range_min];
  scan.range_max = fields[Scalar::range_max];
  scan.sensor = fields[Text::sensor];
  builder.add_scan(std::move(scan));
}

/// Scans of Censi's raw logs carry the counts that were read last, with their own stamps.
void add_scan_ticks(const JsonFields& fields, RecordingBuilder& builder) {
  if (fields[Array::left_timestamp].empty() || fields[Array::right_timestamp].empty()) return;
  add_ticks(fields,
            std::max(split_time(fields[Array::left_timestamp]), split_time(fields[Array::right_timestamp])),
            builder);
}

/// A line may have one wheel only.
std::optional<Side> only_side(const JsonFields& fields) {
  if (fields.has(Scalar::left) == fields.has(Scalar::right)) return std::nullopt;
  return fields.has(Scalar::left) ? Side::left : Side::right;
}

double value_of(const JsonFields& fields, Side side) {
  return fields[side == Side::left ? Scalar::left : Scalar::right];
}

void add_wheels(const JsonFields& fields, RecordingBuilder& builder) {
  if (const auto side = only_side(fields))
    builder.add_wheel(*side, {time_of(fields), value_of(fields, *side)});
  else
    builder.add_wheels({time_of(fields), fields[Scalar::left], fields[Scalar::right]});
}

void add_wheel_speeds(const JsonFields& fields, RecordingBuilder& builder) {
  if (const auto side = only_side(fields))
    builder.add_wheel_speed(*side, {time_of(fields), value_of(fields, *side)});
  else
    builder.add_wheel_speeds({time_of(fields), fields[Scalar::left], fields[Scalar::right]});
}

/// Members without which a line is of use all the same, and what each is where it is of another type. The
/// others are counted with their samples, or refused.
constexpr std::array<std::pair<std::string_view, const char*>, 14> kOptional{{
    {"sensor", " is no text"},
    {"robot_id", " is no text"},
    {"controller", " is no text"},
    {"controller_id", " is no text"},
    {"angles", " is no list of numbers"},
    {"theta", " is no list of numbers"},
    {"times", " is no list of numbers"},
    {"valid", " is no list of numbers"},
    {"ray_dt", " is no list of numbers"},
    {"intensities", " is no list of numbers"},
    {"time_increment", " is no number"},
    {"range_min", " is no number"},
    {"range_max", " is no number"},
    {"time_zero", " is no number"},
}};

void count_wrong_types(const JsonFields& fields, RecordingBuilder& builder) {
  if (fields.wrong_types.empty()) return;
  for (const auto& [member, problem] : kOptional)
    if (fields.is_of_wrong_type(member)) builder.discard("value", std::string(member) + problem);
}

void add_line(const JsonFields& fields, RecordingBuilder& builder) {
  const auto& type = fields[Text::type];
  if (type == "scan") {
    add_scan_ticks(fields, builder);
    add_scan(fields, builder);
  } else if (type == "ticks") {
    add_ticks(fields, time_of(fields), builder);
  } else if (type == "pose") {
    builder.add_pose({time_of(fields), fields[Scalar::x], fields[Scalar::y], fields[Scalar::yaw]});
  } else if (type == "wheels") {
    add_wheels(fields, builder);
  } else if (type == "wheel_speeds") {
    add_wheel_speeds(fields, builder);
  } else if (type == "odometry") {
    builder.add_odometry({time_of(fields), fields[Scalar::x], fields[Scalar::y], fields[Scalar::yaw]});
  } else if (type == "gyro") {
    builder.add_gyro({time_of(fields), fields[Scalar::yaw_rate]});
  } else if (type == "robot") {
    add_robot(fields, builder);
  } else {
    return builder.discard("line", type.empty() ? "no type" : "unknown type");
  }
  count_wrong_types(fields, builder);
}

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == std::string_view::npos; }

}  // namespace

void JsonLines::read_line(std::string_view line, const char* if_wrong) {
  if (is_blank(line)) return;
  if (parse_fields(line, fields_))
    add_line(fields_, *builder_);
  else
    builder_->discard("line", if_wrong);
}

void JsonLines::take(std::string_view piece) {
  for (std::size_t end = piece.find('\n'); end != std::string_view::npos; end = piece.find('\n')) {
    if (begun_.empty()) {
      read_line(piece.substr(0, end), "not valid JSON");
    } else {
      begun_.append(piece.substr(0, end));
      read_line(begun_, "not valid JSON");
      begun_.clear();
    }
    piece.remove_prefix(end + 1);
  }
  begun_.append(piece);
}

void JsonLines::finish() { read_line(begun_, "cut off"); }

}  // namespace odomcalib
