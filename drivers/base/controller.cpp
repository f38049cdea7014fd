#include "drivers/base/controller.hpp"

#include "drivers/base/cia402/axis_pair.hpp"
#include "drivers/base/cia402/dual_axis.hpp"
#include "drivers/base/speed/speed_base.hpp"

namespace odomcalib::drivers {

std::vector<Capability> host_capabilities() {
  std::vector<Capability> all(3);
  all[0].quantity = "left_wheel_diameter";
  all[1].quantity = "right_wheel_diameter";
  all[2].quantity = "track_width";
  return all;
}

Result<std::unique_ptr<Controller>> make_controller(const std::string& profile_path) {
  auto read = read_profile(profile_path);
  if (!read) return read.error();
  Profile profile = std::move(read).value();
  if (!profile.sides.empty()) return std::unique_ptr<Controller>(std::make_unique<AxisPair>(profile));
  if (profile.protocol == "canopen")
    return std::unique_ptr<Controller>(std::make_unique<DualAxis>(std::move(profile)));
  auto protocol = make_speed_protocol(profile);
  if (!protocol) return protocol.error();
  return std::unique_ptr<Controller>(
      std::make_unique<SpeedBase>(std::move(profile), std::move(protocol).value()));
}

}  // namespace odomcalib::drivers
