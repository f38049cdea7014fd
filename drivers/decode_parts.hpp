// Parts of decode(): one function per family of files. Only for drivers/decode*.cpp.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "drivers/base/profile.hpp"
#include "drivers/can/transport.hpp"

namespace odomcalib::drivers {

std::string decode_ld06(std::span<const std::uint8_t> bytes);
std::string decode_candump(const Profile& profile, std::string_view text);

/// The last line: byte accounting, and the named counters as rejections.
inline std::string summary_line(const Counters& counters, std::initializer_list<const char*> rejections) {
  const auto count = [&](const std::string& name) {
    const auto found = counters.find(name);
    return found == counters.end() ? std::uint64_t{0} : found->second;
  };
  nlohmann::ordered_json line = {{"type", "summary"},
                                 {"bytes_in", count("bytes_in")},
                                 {"good", count("good")},
                                 {"skipped", count("skipped")},
                                 {"buffered", count("buffered")}};
  line["rejected"] = nlohmann::ordered_json::object();
  for (const char* name : rejections) line["rejected"][name] = count(name);
  return line.dump() + "\n";
}

}  // namespace odomcalib::drivers
