// CARMEN logs: one message a line, blank-separated. They carry odometry instead of counts; with the robot's
// nominal values the counts behind it are recovered, because odometry was integrated from them with just
// these values.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "proto/recording/recording_readers.hpp"
#include "proto/recording/wheel_motion.hpp"

namespace odomcalib {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kAssumedInterval = 0.2;  // s between scans of a log without time stamps
constexpr std::size_t kMostCarmenBeams = 100'000;
constexpr double kFarthest = 1e4;  // m
constexpr std::string_view kOdomLine = "ODOM", kPlainLaser = "FLASER", kRobotLaser = "ROBOTLASER1";

/// The words of one line; a word that is missing or no number reads as NaN.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view word() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
    const auto out = rest_.substr(0, rest_.find_first_of(" \t\r"));
    rest_.remove_prefix(out.size());
    return out;
  }
  double number() {
    const auto text = word();
    double value = kNoNumber;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : kNoNumber;
  }
  std::size_t count(std::size_t most) {
    const double value = number();
    return value >= 0.0 && value <= static_cast<double>(most) ? static_cast<std::size_t>(value) : most + 1;
  }
  std::array<double, 3> triple() {
    std::array<double, 3> out{};
    for (double& value : out) value = number();
    return out;
  }

 private:
  std::string_view rest_;
};

bool finite(const std::array<double, 3>& pose) { return std::isfinite(pose[0] + pose[1] + pose[2]); }

struct Odometry {
  double t = kNoNumber;
  std::array<double, 3> pose{};
};

bool is_stamped(double t) { return std::isfinite(t); }

struct Log {
  std::vector<Odometry> odometry;       // of ODOM lines
  std::vector<Odometry> scan_odometry;  // of laser lines: used when there are no ODOM lines
  std::vector<Scan> scans;
  std::vector<bool> is_plain;  // of each scan: a FLASER line
  std::optional<std::array<double, 3>> lidar_pose;
  std::string_view open_end;  // message of a last line without its end and without a stamp
};

/// FLASER gives no angles: 180 degrees from the right; an odd number of beams includes both ends.
void set_half_circle(Scan& scan) {
  const auto beams = static_cast<double>(scan.ranges.size());
  scan.angle_min = -std::numbers::pi / 2.0;
  scan.angle_increment =
      std::numbers::pi / (scan.ranges.size() % 2 == 1 ? std::max(1.0, beams - 1.0) : beams);
}

/// "nan" and beyond any lidar: no reading.
bool read_ranges(Words& words, std::vector<float>& ranges) {
  const std::size_t beams = words.count(kMostCarmenBeams);
  if (beams == 0 || beams > kMostCarmenBeams) return false;
  ranges.reserve(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const auto text = words.word();
    if (text.empty()) return false;
    Words one(text);
    const double range = one.number();
    ranges.push_back(range > 0.0 && range < kFarthest ? static_cast<float>(range) : 0.0F);
  }
  return true;
}

/// Time stamps end a line: of the sending program (since 1970, or 0), its host, and of the logger (since its
/// start). NaN: neither is there; programs that know no time write 0.
double read_time(Words& words) {
  const double sent = words.number();
  words.word();
  const double logged = words.number();
  if (sent > 0.0) return sent;
  return logged > 0.0 ? logged : kNoNumber;
}

/// The lidar in the robot's frame, when the log tells the pose of both.
void note_lidar_pose(Log& log, const std::array<double, 3>& laser, const std::array<double, 3>& robot) {
  if (log.lidar_pose || laser == robot) return;
  const double dx = laser[0] - robot[0];
  const double dy = laser[1] - robot[1];
  const double c = std::cos(robot[2]);
  const double s = std::sin(robot[2]);
  log.lidar_pose = {c * dx + s * dy, -s * dx + c * dy,
                    std::remainder(laser[2] - robot[2], 2.0 * std::numbers::pi)};
}

void add_scan(Log& log, Scan scan, const std::array<double, 3>& robot, bool plain) {
  log.scan_odometry.push_back({scan.t, robot});
  log.scans.push_back(std::move(scan));
  log.is_plain.push_back(plain);
}

/// FLASER n ranges x y theta odom_x odom_y odom_theta time host logger_time
bool read_flaser(Words& words, Log& log) {
  Scan scan;
  if (!read_ranges(words, scan.ranges)) return false;
  set_half_circle(scan);
  const auto laser = words.triple();
  const auto robot = words.triple();
  if (!finite(laser) || !finite(robot)) return false;
  scan.t = read_time(words);
  note_lidar_pose(log, laser, robot);
  add_scan(log, std::move(scan), robot, true);
  return true;
}

/// ROBOTLASER1 type start fov step max accuracy remission_mode n ranges m remissions laser_pose robot_pose tv
/// rv forward_safety side_safety turn_axis time host logger_time
bool read_robotlaser(Words& words, Log& log) {
  Scan scan;
  words.number();  // type
  scan.angle_min = words.number();
  words.number();  // field of view
  scan.angle_increment = words.number();
  scan.range_max = words.number();
  words.number();  // accuracy
  words.number();  // remission mode
  if (!read_ranges(words, scan.ranges)) return false;
  const std::size_t remissions = words.count(kMostCarmenBeams);
  if (remissions > kMostCarmenBeams) return false;
  for (std::size_t i = 0; i < remissions; ++i) words.word();
  const auto laser = words.triple();
  const auto robot = words.triple();
  for (int i = 0; i < 5; ++i) words.number();
  scan.t = read_time(words);
  if (!finite(laser) || !finite(robot)) return false;
  note_lidar_pose(log, laser, robot);
  add_scan(log, std::move(scan), robot, false);
  return true;
}

/// ODOM x y theta tv rv accel time host logger_time
bool read_odometry(Words& words, Log& log) {
  Odometry odometry;
  odometry.pose = words.triple();
  for (int i = 0; i < 3; ++i) words.number();
  odometry.t = read_time(words);
  if (!finite(odometry.pose)) return false;
  log.odometry.push_back(odometry);
  return true;
}

bool is_remark(std::string_view word) { return word.empty() || word.starts_with('#'); }

/// Lines that hold nothing for calibration, or the same again.
bool is_other_line(std::string_view word) {
  static constexpr std::array<std::string_view, 12> kOther{"PARAM",   "SYNC",    "TRUEPOS",     "RLASER",
                                                           "LASER3",  "LASER4",  "RAWLASER1",   "RAWLASER2",
                                                           "NMEAGGA", "NMEARMC", "ROBOTLASER2", "MARKER"};
  return std::find(kOther.begin(), kOther.end(), word) != kOther.end();
}

std::string not_taken(std::string_view name) { return std::string(name) + " was not taken"; }

/// Whether the message that was just read lacks its stamp.
bool is_without_stamp(std::string_view name, const Log& log) {
  if (name == kOdomLine) return !is_stamped(log.odometry.back().t);
  return (name == kPlainLaser || name == kRobotLaser) && !is_stamped(log.scans.back().t);
}

void read_carmen_line(std::string_view line, bool last, Log& log, RecordingBuilder& builder) {
  Words words(line);
  const auto name = words.word();
  bool good = true;
  if (name == kPlainLaser)
    good = read_flaser(words, log);
  else if (name == kRobotLaser)
    good = read_robotlaser(words, log);
  else if (name == kOdomLine)
    good = read_odometry(words, log);
  else if (is_other_line(name))
    builder.discard("message", not_taken(name));
  else if (!is_remark(name))
    builder.discard("line", "unknown message");
  if (!good)
    builder.discard("line", last ? "cut off" : "too few or wrong fields");
  else if (last && is_without_stamp(name, log))
    log.open_end = name;
}

/// Whether the scans tell when they were made: a stamp that several of them share and no other one has was
/// made up.
bool has_times(const Log& log) {
  const auto stamped = [](const Scan& scan) { return is_stamped(scan.t); };
  const auto first = std::find_if(log.scans.begin(), log.scans.end(), stamped);
  if (first == log.scans.end()) return false;
  const bool is_only_one = std::none_of(std::next(first), log.scans.end(), stamped);
  return is_only_one || std::any_of(first, log.scans.end(),
                                    [&](const Scan& scan) { return stamped(scan) && scan.t != first->t; });
}

/// A stamp is the end of a line: where other lines have one, the last line was cut off before it.
void drop_open_end(Log& log, RecordingBuilder& builder) {
  if (log.open_end.empty()) return;
  builder.discard("line", "cut off");
  if (log.open_end == kOdomLine) return log.odometry.pop_back();
  log.scans.pop_back();
  log.scan_odometry.pop_back();
  log.is_plain.pop_back();
}

/// Loggers may write a scan as both messages, one after the other: the one that states its angles is kept.
void drop_doubled_scans(Log& log, RecordingBuilder& builder) {
  const auto is_doubled_by = [&](std::size_t i, std::size_t other) {
    return other < log.scans.size() && !log.is_plain[other] && log.scans[other].ranges == log.scans[i].ranges;
  };
  std::vector<bool> doubled(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    doubled[i] = log.is_plain[i] && (is_doubled_by(i, i + 1) || (i > 0 && is_doubled_by(i, i - 1)));
  Log kept;
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    if (!doubled[i]) add_scan(kept, std::move(log.scans[i]), log.scan_odometry[i].pose, log.is_plain[i]);
  builder.discard("message", not_taken(kPlainLaser) + ": the same scan as a " + std::string(kRobotLaser),
                  log.scans.size() - kept.scans.size());
  log.scans = std::move(kept.scans);
  log.scan_odometry = std::move(kept.scan_odometry);
  log.is_plain = std::move(kept.is_plain);
}

/// Some logs were converted without their stamps: a made-up clock keeps them usable, and is reported.
void assume_times(Log& log, RecordingBuilder& builder) {
  builder.discard("time stamp", "the log has none: 0.2 s per scan assumed", log.scans.size());
  builder.discard("message", not_taken(kOdomLine) + ": the scans have no time stamps", log.odometry.size());
  log.odometry.clear();
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    log.scans[i].t = log.scan_odometry[i].t = kAssumedInterval * static_cast<double>(i);
}

/// Large stamps lose precision as seconds since 1970: count from the whole second of the first.
void shift_times(Log& log, RecordingBuilder& builder) {
  const auto stamped = [](const auto& one) { return is_stamped(one.t); };
  const auto first = std::find_if(log.scans.begin(), log.scans.end(), stamped);
  const auto pose = std::find_if(log.odometry.begin(), log.odometry.end(), stamped);
  if (first == log.scans.end() && pose == log.odometry.end()) return;
  const double start = std::floor(first != log.scans.end() ? first->t : pose->t);
  if (start < 1e6) return;
  builder.count_from(start);
  for (auto& scan : log.scans) scan.t -= start;
  for (auto& odometry : log.odometry) odometry.t -= start;
  for (auto& odometry : log.scan_odometry) odometry.t -= start;
}

/// Wheel counts whose odometry, with the nominal values, is the one in the log.
class CarmenCounts {
 public:
  explicit CarmenCounts(const RobotDescription& robot) : robot_(robot) {}

  TickSample at(const Odometry& odometry) {
    if (started_) add(last_, odometry.pose);
    last_ = odometry.pose;
    started_ = true;
    return {odometry.t, count(left_, robot_.left_wheel_diameter), count(right_, robot_.right_wheel_diameter),
            0};
  }

 private:
  void add(const std::array<double, 3>& from, const std::array<double, 3>& to) {
    const auto ways = wheel_ways(from, to, robot_.track_width);
    left_ += ways[0];
    right_ += ways[1];
  }
  [[nodiscard]] std::int64_t count(double path, double diameter) const {
    const double counts = path / (std::numbers::pi * diameter) * robot_.ticks_per_rev;
    return std::abs(counts) < 1e15 ? std::llround(counts) : 0;
  }

  const RobotDescription& robot_;
  std::array<double, 3> last_{};
  bool started_ = false;
  double left_ = 0.0, right_ = 0.0;  // m
};

/// Counts of the encoders where their resolution is known; else the motion is that of the odometry.
void add_motion(const Log& log, const RobotDescription& robot, RecordingBuilder& builder) {
  const auto stamped = std::count_if(log.odometry.begin(), log.odometry.end(),
                                     [](const Odometry& one) { return is_stamped(one.t); });
  if (stamped < 2)
    builder.discard("message", not_taken(kOdomLine) + ": fewer than two have a time stamp",
                    log.odometry.size());
  const auto& odometry = stamped < 2 ? log.scan_odometry : log.odometry;
  CarmenCounts counts(robot);
  for (const auto& sample : odometry)
    if (robot.ticks_per_rev == 0.0)
      builder.add_odometry({sample.t, sample.pose[0], sample.pose[1], sample.pose[2]});
    else
      builder.add_ticks(counts.at(sample));
}

}  // namespace

bool looks_like_carmen(std::string_view text) {
  for (int lines = 0; lines < 1000 && !text.empty(); ++lines) {
    const std::size_t end = text.find('\n');
    Words words(text.substr(0, end));
    const auto name = words.word();
    if (name == kPlainLaser || name == kRobotLaser || name == kOdomLine || name == "PARAM") return true;
    if (!is_remark(name) && !is_other_line(name)) return false;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return false;
}

void read_carmen(std::string_view text, const RobotDescription* robot, RecordingBuilder& builder) {
  Log log;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const bool last = end == std::string_view::npos;
    read_carmen_line(text.substr(0, end), last, log, builder);
    text.remove_prefix(last ? text.size() : end + 1);
  }
  if (has_times(log)) drop_open_end(log, builder);
  drop_doubled_scans(log, builder);
  if (!log.scans.empty() && !has_times(log)) assume_times(log, builder);
  shift_times(log, builder);
  RobotDescription description = robot != nullptr ? *robot : RobotDescription{};
  if (!description.lidar_pose) description.lidar_pose = log.lidar_pose;
  if (description.ticks_per_rev == 0.0 || !check_robot(description, ""))
    add_motion(log, description, builder);
  for (auto& scan : log.scans) builder.add_scan(std::move(scan));
  builder.add_robot(std::move(description));
}

}  // namespace odomcalib
