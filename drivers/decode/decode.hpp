// Recorded bytes of a device as JSON Lines, for `odomcalibctl decode DRIVER FILE`.
#pragma once

#include <string>
#include <string_view>

#include "proto/result.hpp"

namespace odomcalib::drivers {

/// Decodes a whole file. One JSON object a line: scans and ticks as in a recording, anything else as
/// {"type":"message",...}, and last
/// {"type":"summary","bytes_in","good","skipped","buffered","rejected":{name:count}}.
/// @param driver a lidar's type (raw bytes, hexadecimal text, or a session), or a controller's
/// "PROTOCOL:PROFILE",
///               e.g. "canopen:zlac8015d" or "vesc" (a candump log; bytes for serial bases). PROFILE is a
///               name in profile_folder or the path of a TOML file
/// @param where name of the file, for messages
/// Errors: usage (unknown driver), io and format (profile). Damaged input is no error: the summary counts it.
Result<std::string> decode(const std::string& driver, std::string_view bytes,
                           const std::string& profile_folder, const std::string& where);

}  // namespace odomcalib::drivers
