#include "daemon/cli/recordings.hpp"

#include <algorithm>

#include "daemon/config/robot_file.hpp"

namespace odomcalib::cli {

namespace {

bool same_ticks(const Recording& a, const Recording& b) {
  const auto same = [](const TickSample& x, const TickSample& y) {
    return x.t == y.t && x.left == y.left && x.right == y.right;
  };
  return !a.ticks.empty() && std::equal(a.ticks.begin(), a.ticks.end(), b.ticks.begin(), b.ticks.end(), same);
}

/// The same bytes, or the same counts at the same times: packed, or with other scans, they are still one
/// drive, and one drive is no independent proof of itself.
const Recording* same_drive(const std::vector<Recording>& recordings, const Recording& next) {
  for (const Recording& one : recordings)
    if (one.sha256 == next.sha256 || same_ticks(one, next)) return &one;
  return nullptr;
}

}  // namespace

Result<std::vector<Recording>> read_recordings(const std::vector<std::string>& paths,
                                               const std::string& robot_file) {
  RobotDescription robot;
  if (!robot_file.empty()) {
    const auto given = read_robot_file(robot_file);
    if (!given) return given.error();
    robot = given.value();
  }
  std::vector<Recording> recordings;
  for (const auto& path : paths) {
    auto recording = read_recording(path, robot_file.empty() ? nullptr : &robot);
    if (!recording) return recording.error();
    if (const Recording* one = same_drive(recordings, recording.value()))
      return Error{ErrorCode::usage, "holds the same drive as \"" + one->name + "\"", path,
                   "name every recording once"};
    recording.value().robot = overlaid(recording.value().robot, robot);
    recordings.push_back(std::move(recording).value());
  }
  return recordings;
}

}  // namespace odomcalib::cli
