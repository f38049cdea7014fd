// Parts of decode(): one function per family of files. Only for drivers/decode/*.cpp.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "drivers/base/profile/profile.hpp"
#include "drivers/can/transport.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

std::string decode_lidar(Lidar& lidar, std::span<const std::uint8_t> bytes);
std::string decode_canopen(const Profile& profile, std::string_view text);
/// Every other controller: a candump log, or bytes, as the protocol has it.
Result<std::string> decode_speed(const Profile& profile, std::string_view text,
                                 std::span<const std::uint8_t> bytes);

/// The last line: byte accounting, and the rejections by name.
inline std::string summary_line(Counters counters, const Counters& rejected) {
  nlohmann::ordered_json line = {{"type", "summary"},
                                 {"bytes_in", counters["bytes_in"]},
                                 {"good", counters["good"]},
                                 {"skipped", counters["skipped"]},
                                 {"buffered", counters["buffered"]}};
  line["rejected"] = rejected;
  return line.dump() + "\n";
}

inline std::string summary_line(const Counters& counters, std::initializer_list<const char*> rejections) {
  Counters rejected;
  for (const char* name : rejections) rejected[name] = counters.contains(name) ? counters.at(name) : 0;
  return summary_line(counters, rejected);
}

}  // namespace odomcalib::drivers
