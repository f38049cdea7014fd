#include "drivers/base/controller.hpp"

#include "drivers/base/cia402/dual_axis.hpp"
#include "drivers/base/speed/speed_protocol.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::drivers {

// Each in the file of its name.
std::unique_ptr<Controller> make_axis_pair(const Profile& profile);
std::unique_ptr<Controller> make_speed_base(Profile profile, std::unique_ptr<SpeedProtocol> protocol);

std::vector<Capability> host_capabilities() {
  std::vector<Capability> all(kDriveLengths.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k].quantity = name_of(kDriveLengths[k]);
  return all;
}

Result<std::unique_ptr<Controller>> make_controller(const std::string& profile_path) {
  auto read = read_profile(profile_path);
  if (!read) return read.error();
  Profile profile = std::move(read).value();
  if (!profile.sides.empty()) return make_axis_pair(profile);
  if (profile.protocol == "canopen")
    return std::unique_ptr<Controller>(std::make_unique<DualAxis>(std::move(profile)));
  auto protocol = make_speed_protocol(profile);
  if (!protocol) return protocol.error();
  return make_speed_base(std::move(profile), std::move(protocol).value());
}

}  // namespace odomcalib::drivers
