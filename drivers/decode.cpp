#include "drivers/decode.hpp"

#include "drivers/capture_file.hpp"
#include "drivers/decode_parts.hpp"

namespace odomcalib::drivers {
namespace {

std::string profile_path(const std::string& name, const std::string& folder) {
  const bool is_path = name.find('/') != std::string::npos || name.ends_with(".toml");
  return is_path ? name : folder + "/" + name + ".toml";
}

}  // namespace

Result<std::string> decode(const std::string& driver, std::string_view bytes,
                           const std::string& profile_folder, const std::string& where) {
  const std::string prefix = "canopen:";
  if (!driver.starts_with(prefix)) {
    LidarOptions options;
    options.device_time = true;
    const auto lidar = make_lidar(driver, options);
    if (lidar) return decode_lidar(*lidar.value(), device_bytes(bytes));
  }
  if (!driver.starts_with(prefix) || driver.size() == prefix.size())
    return Error{ErrorCode::usage, "unknown driver \"" + driver + "\"", where,
                 "known: canopen:PROFILE (e.g. canopen:zlac8015d), " + lidar_type_names()};
  const auto profile = read_profile(profile_path(driver.substr(prefix.size()), profile_folder));
  if (!profile) return profile.error();
  return decode_candump(profile.value(), bytes);
}

}  // namespace odomcalib::drivers
