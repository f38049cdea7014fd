#include "daemon/cli/recordings.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "daemon/cli/options.hpp"
#include "daemon/cli/output.hpp"
#include "daemon/cli/settings.hpp"
#include "daemon/config/robot_file.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib::cli {

namespace {

/// Whether each sample of one is among those of the other, at the same time; both in order of time.
/// @param later s, by which times of the other count from later
template <typename Sample, typename Same>
bool all_among(const std::vector<Sample>& one, const std::vector<Sample>& other, double later, Same same) {
  auto from = other.begin();
  for (const Sample& x : one) {
    from = std::find_if(from, other.end(), [&](const Sample& y) {
      return std::abs(y.t - x.t + later) < settings::kSameTime_s && same(x, y);
    });
    if (from == other.end()) return false;
    ++from;
  }
  return !one.empty();
}

/// The same counts, scans or reference poses at the same times.
bool is_among(const Recording& one, const Recording& other) {
  const double later = other.time_zero - one.time_zero;
  return all_among(one.ticks, other.ticks, later,
                   [](const auto& x, const auto& y) { return x.left == y.left && x.right == y.right; }) ||
         all_among(one.scans, other.scans, later,
                   [](const auto& x, const auto& y) { return x.ranges == y.ranges; }) ||
         all_among(one.poses, other.poses, later,
                   [](const auto& x, const auto& y) { return x.x == y.x && x.y == y.y && x.yaw == y.yaw; });
}

/// Packed, cut, with other scans, or with the wheels by another topic, it is still one drive, and one drive
/// is no independent proof of itself.
const Recording* same_drive(const std::vector<Recording>& recordings, const Recording& next) {
  for (const Recording& one : recordings)
    if (one.sha256 == next.sha256 || is_among(one, next) || is_among(next, one)) return &one;
  return nullptr;
}

}  // namespace

std::string to_arguments(const RecordingOptions& options) {
  std::string text;
  const auto add = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {} {}", name, shell_word(value));
  };
  add("--robot", options.robot_file);
  add("--robot-id", options.robot_id);
  if (options.unpack_limit > 0.0) add("--unpack-limit", fmt::format("{:g}", options.unpack_limit));
  for (const std::string& topic : options.topics) add("--topic", topic);
  return text;
}

Result<TopicChoices> topic_choices_of(const RecordingOptions& options) {
  TopicChoices choices;
  for (const auto& text : options.topics) {
    auto choice = parse_topic_choice(text);
    if (!choice) return choice.error();
    choices.push_back(std::move(choice).value());
  }
  return choices;
}

Result<RobotDescription> robot_of(const RecordingOptions& options) {
  RobotDescription robot;
  if (!options.robot_file.empty()) {
    const auto given = read_robot_file(options.robot_file);
    if (!given) return given.error();
    robot = given.value();
  }
  if (!options.robot_id.empty()) robot.robot_id = options.robot_id;
  return robot;
}

Recording with_nominal(Recording recording, RobotDescription robot) {
  // Counts that were made of something else have the resolution that they were made with.
  if (recording.motion != MotionSource::ticks) robot.ticks_per_rev = 0.0;
  recording.robot = overlaid(recording.robot, robot);
  return recording;
}

void add_unpack_limit(CLI::App& verb, double& limit) {
  verb.add_option("--unpack-limit", limit,
                  "MiB that a packed file may unpack to, where it can be trusted (256, JSON Lines 1024, and "
                  "less for small files)")
      ->check(finite(1.0, 1e6));
}

UnpackLimit unpack_limit_of(double mebibytes) {
  constexpr double kMebibyte = 1048576.0;
  return mebibytes > 0.0 ? UnpackLimit::allowed(static_cast<std::size_t>(mebibytes * kMebibyte))
                         : UnpackLimit{};
}

void add_reading_options(CLI::App& verb, RecordingOptions& options) {
  verb.add_option("--robot", options.robot_file, "nominal values (TOML) instead of those of the recording");
  verb.add_option("--robot-id", options.robot_id,
                  "name of the robot, instead of that of the recording or of --robot");
  add_unpack_limit(verb, options.unpack_limit);
  verb.add_option("--topic", options.topics,
                  "of a ROS recording: PART=TOPIC, or wheels=TOPIC:LEFT,RIGHT with the joints, or "
                  "wheels=LEFT_TOPIC,RIGHT_TOPIC; parts are scan, "
                  "wheels, wheel_speeds, odometry, gyro, pose; may be repeated")
      ->take_all()
      ->allow_extra_args(false);  // what follows may be the recording
}

Result<std::vector<Recording>> read_recordings(const std::vector<std::string>& paths,
                                               const RecordingOptions& options, Intensities intensities) {
  const auto topics = topic_choices_of(options);
  if (!topics) return topics.error();
  const auto robot = robot_of(options);
  if (!robot) return robot.error();
  std::vector<Recording> recordings;
  for (const auto& path : paths) {
    auto recording = [&] {
      const Meanwhile shown("reading " + path);
      return read_recording(path, &robot.value(), topics.value(), unpack_limit_of(options.unpack_limit),
                            intensities);
    }();
    if (!recording) {
      for (const auto& remark : recording.error().remarks) tell(fmt::format("{}: {}", path, remark));
      return recording.error();
    }
    for (const auto& choice : recording.value().choices) tell(fmt::format("{}: {}", path, choice));
    for (const Repair& one : recording.value().repairs)
      tell(fmt::format("{}: {}: {}: {}", path, one.what, one.chosen, one.reason));
    if (const Recording* one = same_drive(recordings, recording.value()))
      return Error{ErrorCode::usage, "holds the same drive as \"" + one->name + "\", or a part of it", path,
                   "name every drive once, as a whole"};
    recordings.push_back(with_nominal(std::move(recording).value(), robot.value()));
  }
  return recordings;
}

}  // namespace odomcalib::cli
