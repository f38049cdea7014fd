#include "daemon/cli/recordings.hpp"

#include "daemon/config/robot_file.hpp"

namespace odomcalib::cli {

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
    recording.value().robot = overlaid(recording.value().robot, robot);
    recordings.push_back(std::move(recording).value());
  }
  return recordings;
}

}  // namespace odomcalib::cli
