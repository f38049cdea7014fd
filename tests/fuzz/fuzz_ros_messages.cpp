// ROS messages: the first byte says which type and encoding, the rest is the message.
#include <cmath>
#include <string_view>

#include "proto/recording/ros/messages.hpp"
#include "proto/recording/ros/mounting.hpp"
#include "proto/recording/ros/urdf.hpp"
#include "tests/fuzz/share.hpp"

using odomcalib::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace odomcalib::ros;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  const Encoding encoding = (data[0] & 1U) == 0 ? Encoding::ros1 : Encoding::cdr;
  switch (data[0] / 2 % 7) {
    case 0:
      if (const auto scan = decode_scan(bytes, encoding)) {
        require(scan->scan.ranges.size() <= size / sizeof(float));
        for (const float range : scan->scan.ranges) require(std::isfinite(range));
        require(scan->scan.intensities.empty() || scan->scan.intensities.size() == scan->scan.ranges.size());
      }
      break;
    case 1:
      if (const auto joints = decode_joints(bytes, encoding)) {
        require(joints->names.size() <= size / 4);
        require(joints->positions.empty() || joints->positions.size() == joints->names.size());
        require(joints->velocities.empty() || joints->velocities.size() == joints->names.size());
      }
      break;
    case 2:
      (void)decode_imu(bytes, encoding);
      break;
    case 3:
      if (const auto pose = decode_odometry(bytes, encoding))
        require(!std::isinf(pose->yaw));  // NaN: no rotation
      break;
    case 4:
      if (const auto pose = decode_pose(bytes, encoding))
        require(!std::isinf(pose->yaw));  // NaN: no rotation
      break;
    case 5:
      if (const auto read = decode_transforms(bytes, encoding)) {
        const auto& transforms = read->usable;
        require(transforms.size() + read->unusable <= size / (7 * sizeof(double)));
        if (transforms.empty()) break;
        const auto found = mounting_of(transforms, {transforms.front().frame}, transforms.back().child);
        require(!found || std::isfinite(found->pose[0] + found->pose[1] + found->pose[2]));
      }
      break;
    default:
      if (const auto text = decode_text(bytes, encoding))
        for (const Transform& joint : fixed_joints(*text).value_or(Transforms{}).usable) {
          require(!joint.frame.empty() && !joint.child.empty());
          for (const double one : joint.position) require(std::isfinite(one));
          for (const double one : joint.quaternion) require(std::isfinite(one));
        }
      break;
  }
  return 0;
}
