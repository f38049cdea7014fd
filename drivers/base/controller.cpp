#include "drivers/base/controller.hpp"

#include "drivers/base/cia402/axis_pair.hpp"
#include "drivers/base/cia402/dual_axis.hpp"
#include "drivers/base/speed/speed_base.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::drivers {

std::vector<Capability> host_capabilities() {
  std::vector<Capability> all(kDriveLengths.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k].quantity = name_of(kDriveLengths[k]);
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
