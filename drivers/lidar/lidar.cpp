#include "drivers/lidar/lidar.hpp"

#include "drivers/lidar/ld06/ld06.hpp"

namespace odomcalib::drivers {

Result<std::unique_ptr<Lidar>> make_lidar(const std::string& type, unsigned baud) {
  if (baud == 0) return Error{ErrorCode::usage, "baud rate must not be 0", "lidar", ""};
  if (type == "ld06" || type == "ld19") return std::unique_ptr<Lidar>(std::make_unique<Ld06>(baud));
  return Error{ErrorCode::usage, "unknown lidar type \"" + type + "\"", "lidar", "known: ld06, ld19"};
}

}  // namespace odomcalib::drivers
