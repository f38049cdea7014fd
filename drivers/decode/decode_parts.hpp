// Parts of decode(): one function per family of files. Only for drivers/decode/*.cpp.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/can/transport.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

std::string decode_lidar(Lidar& lidar, std::span<const std::uint8_t> bytes);
/// A network capture of a lidar that comes over TCP.
/// @param port the lidar's usual one
/// Errors: format (no capture of TCP), usage (several devices in it).
Result<std::string> decode_lidar_capture(Lidar& lidar, unsigned port, std::string_view file,
                                         const std::string& where);
/// Error format: not a log of candump, and which one.
Result<std::string> decode_canopen(const Profile& profile, std::string_view text, const std::string& where);
/// Every other controller: a candump log, or bytes, as the protocol has it.
/// Errors: format as above, usage (no such protocol).
Result<std::string> decode_speed(const Profile& profile, std::string_view text,
                                 std::span<const std::uint8_t> bytes, const std::string& where);

/// A tick reading as in a recording; `segment` says where counts began anew.
inline nlohmann::ordered_json tick_line(const TickSample& sample) {
  nlohmann::ordered_json line = {
      {"type", "ticks"}, {"t", sample.t}, {"left", sample.left}, {"right", sample.right}};
  if (sample.segment != 0) line["segment"] = sample.segment;
  return line;
}

/// Remark on a reading beside its sample; null when it is plain motion.
inline nlohmann::ordered_json count_note(Side side, std::int64_t raw, double t,
                                         const WheelCounts::Reading& reading) {
  using enum TickUnwrap::Reading::Kind;
  if (reading.kind == motion) return nullptr;
  const bool is_wild = reading.kind == wild;
  return {{"type", "message"},
          {"t", t},
          {"name", is_wild ? "wild_count" : "counter_restarted"},
          {"side", to_text(side)},
          {"count", raw},
          {"text", is_wild ? "no wheel turns so fast: it is not used" : "a new segment begins"}};
}

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
