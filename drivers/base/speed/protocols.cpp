// The one place that knows all of them: a new protocol is a folder and a line here.
#include "drivers/base/agilex/agilex.hpp"
#include "drivers/base/arcos/arcos.hpp"
#include "drivers/base/odrive/odrive.hpp"
#include "drivers/base/ros_arduino/ros_arduino.hpp"
#include "drivers/base/segway/segway.hpp"
#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/base/vesc/vesc.hpp"

namespace odomcalib::drivers {

Result<std::unique_ptr<SpeedProtocol>> make_speed_protocol(const Profile& profile) {
  std::unique_ptr<SpeedProtocol> made;
  if (profile.protocol == "agilex") made = std::make_unique<Agilex>(profile);
  if (profile.protocol == "arcos") made = std::make_unique<Arcos>(profile);
  if (profile.protocol == "odrive") made = std::make_unique<Odrive>(profile);
  if (profile.protocol == "ros_arduino") made = std::make_unique<RosArduino>(profile);
  if (profile.protocol == "segway") made = std::make_unique<Segway>(profile);
  if (profile.protocol == "vesc") made = std::make_unique<Vesc>(profile);
  if (made) return made;
  return Error{ErrorCode::usage, "\"" + profile.protocol + "\" is not a protocol of wheel speeds",
               profile.name, "agilex, arcos, odrive, ros_arduino, segway, vesc"};
}

}  // namespace odomcalib::drivers
