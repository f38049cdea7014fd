#include "tests/sim/wires/truth_json.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace odomcalib::sim {

namespace {

nlohmann::ordered_json parameters(const Geometry& geometry) {
  return {{"left_wheel_diameter", geometry.left_diameter},
          {"right_wheel_diameter", geometry.right_diameter},
          {"track_width", geometry.track_width},
          {"lidar_x", geometry.lidar.x},
          {"lidar_y", geometry.lidar.y},
          {"lidar_yaw", geometry.lidar.yaw}};
}

nlohmann::ordered_json described(const DrawnEffect& effect) {
  if (effect.kind == nullptr) return nullptr;
  return {{"name", effect.kind->name},
          {"catalogue_name", effect.kind->catalogue_name},
          {"depends_on", effect.kind->depends_on},
          {"size", effect.size},
          {"unit", effect.kind->unit}};
}

}  // namespace

std::string truth_json(const SimRobot& robot, const DrawnEffect& effect) {
  const Pose& pose = robot.pose();
  const nlohmann::ordered_json json{{"seed", robot.seed()},
                                    {"true", parameters(robot.truth())},
                                    {"nominal", parameters(robot.nominal())},
                                    {"effect", described(effect)},
                                    {"ticks_per_rev", robot.nominal().ticks_per_rev},
                                    {"can", robot.can_device()},
                                    {"lidar", robot.lidar_device()},
                                    {"t", robot.now()},
                                    {"pose", {pose.x, pose.y, pose.yaw}}};
  return json.dump(2) + "\n";
}

Result<void> write_truth(const SimRobot& robot, const std::filesystem::path& path,
                         const DrawnEffect& effect) {
  const std::filesystem::path fresh = path.string() + ".new";
  std::ofstream file(fresh);
  file << truth_json(robot, effect);
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(fresh, path, error);
  if (!file || error) return Error{ErrorCode::io, "cannot write the truth", path.string(), ""};
  return {};
}

}  // namespace odomcalib::sim
