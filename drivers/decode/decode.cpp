#include "drivers/decode/decode.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "drivers/decode/capture_file.hpp"
#include "drivers/decode/decode_parts.hpp"
#include "drivers/decode/network_capture.hpp"

namespace odomcalib::drivers {
namespace {

/// "PROTOCOL:PROFILE"; without a profile, the shipped one of that name.
struct Choice {
  std::string protocol, profile;
};

std::optional<Choice> controller_choice(const std::string& driver) {
  constexpr std::array kProtocols = {"canopen", "agilex", "arcos", "odrive", "ros_arduino", "segway", "vesc"};
  const std::size_t colon = driver.find(':');
  Choice choice{driver.substr(0, colon), ""};
  if (std::find(kProtocols.begin(), kProtocols.end(), choice.protocol) == kProtocols.end())
    return std::nullopt;
  if (colon != std::string::npos)
    choice.profile = driver.substr(colon + 1);
  else
    choice.profile = choice.protocol == "canopen" ? "cia402-pair" : choice.protocol;
  return choice.profile.empty() ? std::nullopt : std::optional(choice);
}

std::string profile_path(const std::string& name, const std::string& folder) {
  const bool is_path = name.find('/') != std::string::npos || name.ends_with(".toml");
  return is_path ? name : folder + "/" + name + ".toml";
}

Error no_network(const std::string& driver, const std::string& where) {
  return {ErrorCode::usage, "this is a network capture, and \"" + driver + "\" does not come over TCP", where,
          "give the bytes of its serial line, or a log of `candump -L`"};
}

Result<std::string> decode_lidar_file(const std::string& driver, std::string_view bytes,
                                      const std::string& where) {
  LidarOptions options;
  options.device_time = true;
  const auto type = find_lidar_type(driver);
  const auto lidar = make_lidar(driver, options);
  if (!type || !lidar)
    return Error{
        ErrorCode::usage, "unknown driver \"" + driver + "\"", where,
        "known: " + lidar_type_names() +
            ", and with a profile after a colon: canopen (e.g. canopen:zlac8015d), agilex, arcos, odrive, "
            "ros_arduino, segway, vesc"};
  if (!is_network_capture(bytes)) return decode_lidar(*lidar.value(), device_bytes(bytes));
  if (type.value().port == 0) return no_network(driver, where);
  return decode_lidar_capture(*lidar.value(), type.value().port, bytes, where);
}

}  // namespace

Result<std::string> decode(const std::string& driver, std::string_view bytes,
                           const std::string& profile_folder, const std::string& where) {
  const auto choice = controller_choice(driver);
  if (!choice) return decode_lidar_file(driver, bytes, where);
  if (is_network_capture(bytes)) return no_network(driver, where);
  const auto profile = read_profile(profile_path(choice->profile, profile_folder));
  if (!profile) return profile.error();
  if (profile.value().protocol != choice->protocol)
    return Error{ErrorCode::usage,
                 "profile \"" + choice->profile + "\" is for \"" + profile.value().protocol +
                     "\", not for \"" + choice->protocol + "\"",
                 where, ""};
  if (choice->protocol == "canopen") return decode_canopen(profile.value(), bytes, where);
  // Lines of text may be nothing but digits: they are no hexadecimal notation.
  const bool is_text = choice->protocol == "ros_arduino";
  return decode_speed(profile.value(), bytes,
                      is_text ? std::vector<std::uint8_t>(bytes.begin(), bytes.end()) : device_bytes(bytes),
                      where);
}

}  // namespace odomcalib::drivers
