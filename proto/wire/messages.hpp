// LCM messages of package odomcalib (proto/lcm/*.lcm): value types to bytes and back. The daemon publishes
// and records the same bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib::messages {

/// One instant on both clocks. mono_ns is what intervals are computed from; utime may step.
struct Stamp {
  std::int64_t utime = 0;    ///< us since 1970
  std::int64_t mono_ns = 0;  ///< ns, CLOCK_MONOTONIC
};

/// Seconds of a stamp as recordings use them.
inline double seconds(const Stamp& stamp) { return static_cast<double>(stamp.mono_ns) / 1e9; }

/// How a time stamp came about (ticks_t, scan_t: time_source).
enum class TimeSource : std::int8_t {
  arrival = 0,
  arrival_corrected = 1,
  device_clock = 2,
  hardware = 3,
  sync_echo = 4,
  request_midpoint = 5
};

struct Origin {
  std::int32_t seq = 0;
  TimeSource time_source = TimeSource::arrival;
  std::int32_t time_uncertainty_us = 0;
};

enum class Severity : std::int8_t { info = 0, warning = 1, stop = 2, fault = 3 };

// Encoded messages, fingerprint included. Numbers that are not finite are written as 0, texts end at their
// first NUL. Scans: angles, ranges and times travel as float (24 bits of precision); times of samples are in
// the stamp, not in `t`.
std::string encode(std::int64_t utime, const RobotDescription& robot);
std::string encode(const Stamp& stamp, const TickSample& ticks, const Origin& origin = {});
std::string encode(const Stamp& stamp, const Scan& scan, const Origin& origin = {}, bool complete = true);
std::string encode(const Stamp& stamp, const PoseSample& pose);
std::string encode(const Stamp& stamp, const GyroSample& gyro);
std::string encode_path(std::int64_t utime, const std::string& name, const std::vector<PoseSample>& path);
std::string encode_event(const Stamp& stamp, Severity severity, const std::string& code,
                         const std::string& text);
std::string encode_json(std::int64_t utime, const std::string& format, const std::string& json);

struct TicksMessage {
  Stamp stamp;
  TickSample ticks;  ///< t = seconds(stamp)
  Origin origin;
};
struct ScanMessage {
  Stamp stamp;
  Scan scan;
  Origin origin;
  bool complete = true;
};
struct PoseMessage {
  Stamp stamp;
  PoseSample pose;
};
struct GyroMessage {
  Stamp stamp;
  GyroSample gyro;
};
struct EventMessage {
  Stamp stamp;
  Severity severity = Severity::info;
  std::string code;
  std::string text;
};
struct JsonMessage {
  std::int64_t utime = 0;
  std::string format;
  std::string json;
};

// Decoders for hostile bytes: nullopt for another fingerprint, a wrong length, an array or text that does not
// fit. (The decoders that lcm-gen makes allocate whatever a length field says and throw on an empty text.)
std::optional<RobotDescription> decode_robot(std::string_view bytes);
std::optional<TicksMessage> decode_ticks(std::string_view bytes);
std::optional<ScanMessage> decode_scan(std::string_view bytes);
std::optional<PoseMessage> decode_pose(std::string_view bytes);
std::optional<GyroMessage> decode_gyro(std::string_view bytes);
std::optional<EventMessage> decode_event(std::string_view bytes);
std::optional<JsonMessage> decode_json(std::string_view bytes);

// Fingerprints: the first eight bytes of each message (protocol text, section 2).
constexpr std::uint64_t kRobotFingerprint = 0xe7b341c5f97392ee;
constexpr std::uint64_t kTicksFingerprint = 0x1e7ffc7532290eb9;
constexpr std::uint64_t kScanFingerprint = 0x179f2043430ed99c;
constexpr std::uint64_t kPoseFingerprint = 0x28e47ebeb05766e2;
constexpr std::uint64_t kGyroFingerprint = 0xc722c864341443f5;
constexpr std::uint64_t kPathFingerprint = 0xf74c516dcc36f819;
constexpr std::uint64_t kEventFingerprint = 0x96fceb71ae149523;
constexpr std::uint64_t kJsonFingerprint = 0xe560d2700a250ff9;

/// The fingerprint of a message, or nullopt when it is shorter than eight bytes.
std::optional<std::uint64_t> fingerprint(std::string_view bytes);

}  // namespace odomcalib::messages
