#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

// Each in the folder of its name: a new protocol is a folder, and two lines here.
using Make = std::unique_ptr<SpeedProtocol>(const Profile& profile);
Make make_agilex, make_arcos, make_odrive, make_ros_arduino, make_segway, make_vesc;

Result<std::unique_ptr<SpeedProtocol>> make_speed_protocol(const Profile& profile) {
  if (profile.protocol == "agilex") return make_agilex(profile);
  if (profile.protocol == "arcos") return make_arcos(profile);
  if (profile.protocol == "odrive") return make_odrive(profile);
  if (profile.protocol == "ros_arduino") return make_ros_arduino(profile);
  if (profile.protocol == "segway") return make_segway(profile);
  if (profile.protocol == "vesc") return make_vesc(profile);
  return Error{ErrorCode::usage, "\"" + profile.protocol + "\" is not a protocol of wheel speeds",
               profile.name, "agilex, arcos, odrive, ros_arduino, segway, vesc"};
}

}  // namespace odomcalib::drivers
