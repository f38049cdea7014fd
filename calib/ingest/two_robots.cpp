#include "calib/ingest/two_robots.hpp"

namespace odomcalib::calib::ingest {
namespace {

bool same_size(const RobotDescription& a, const RobotDescription& b) {
  return a.ticks_per_rev == b.ticks_per_rev && a.left_wheel_diameter == b.left_wheel_diameter &&
         a.right_wheel_diameter == b.right_wheel_diameter && a.track_width == b.track_width;
}

std::optional<Error> two_sizes(std::span<const Recording> recordings) {
  for (const Recording& recording : recordings)
    if (!same_size(recording.robot, recordings.front().robot))
      return Error{ErrorCode::format, "nominal values differ from those of " + recordings.front().name,
                   recording.name, "solve recordings of different robots separately"};
  return std::nullopt;
}

std::optional<Error> two_names(std::span<const Recording> recordings) {
  const Recording* known = nullptr;
  for (const Recording& recording : recordings) {
    if (recording.robot.robot_id.empty()) continue;
    if (known == nullptr) known = &recording;
    if (recording.robot.robot_id == known->robot.robot_id) continue;
    return Error{ErrorCode::refused,
                 "is of robot \"" + recording.robot.robot_id + "\", but " + known->name + " of \"" +
                     known->robot.robot_id + "\"",
                 recording.name,
                 "solve each robot's recordings separately, or say --same-robot where only the name changed"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> two_robots(std::span<const Recording> recordings, bool same_robot) {
  if (auto error = two_sizes(recordings)) return error;
  return same_robot ? std::nullopt : two_names(recordings);
}

}  // namespace odomcalib::calib::ingest
