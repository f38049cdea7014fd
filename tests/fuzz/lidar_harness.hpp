// Bytes through a lidar driver: the first byte says how the rest is cut into reads and whether it is decoded
// as it arrives from a device or from a file. Scans must be finite and complete, and every byte accounted
// for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/lidar/lidar.hpp"
#include "tests/fuzz/share.hpp"

namespace odomcalib::fuzz {

inline void check(const drivers::LidarScan& given) {
  const Scan& scan = given.scan;
  require(std::isfinite(scan.t) && std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment));
  require(scan.angles.empty() || scan.angles.size() == scan.ranges.size());
  require(scan.times.empty() || scan.times.size() == scan.ranges.size());
  require(scan.intensities.empty() || scan.intensities.size() == scan.ranges.size());
  for (const float range : scan.ranges) require(std::isfinite(range) && range >= 0.0F);
}

inline void check_accounting(const drivers::Counters& counters) {
  require(counters.at("bytes_in") == counters.at("good") + counters.at("skipped") + counters.at("buffered"));
}

/// Bytes of a new connection are read as if nothing had been before.
inline void start_anew(drivers::Lidar& lidar, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSome = 64;
  lidar.reset();
  (void)lidar.stop_bytes();
  lidar.on_bytes(bytes.first(std::min(bytes.size(), kSome)), 100.0);
  check_accounting(lidar.counters());
}

inline void check_words(const drivers::Lidar& lidar) {
  (void)lidar.problem();
  (void)lidar.identity();
  (void)lidar.rejected();
}

/// @param closely count after every read, listen to messages, begin anew at the end
inline void feed_lidar(const std::string& type, bool device_time, bool closely,
                       std::span<const std::uint8_t> bytes) {
  drivers::LidarOptions options;
  options.baud = 115'200;
  options.device_time = device_time;
  const auto made = drivers::make_lidar(type, options);
  require(made.ok());
  drivers::Lidar& lidar = *made.value();
  if (closely) lidar.set_listener([](const drivers::LidarMessage&) {});
  const std::size_t piece = 1U + bytes[0];
  double now = 0.0;
  for (auto rest = bytes.subspan(1); !rest.empty(); now += 0.002) {
    const std::size_t n = std::min(rest.size(), piece);
    lidar.on_bytes(rest.first(n), now);
    rest = rest.subspan(n);
    (void)lidar.take_output();
    for (const auto& scan : lidar.take_scans()) check(scan);
    if (closely) check_accounting(lidar.counters());
  }
  lidar.finish();
  for (const auto& scan : lidar.take_scans()) check(scan);
  check_accounting(lidar.counters());
  if (!closely) return;
  check_words(lidar);
  start_anew(lidar, bytes);
}

inline void feed_lidar(const std::string& type, const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const std::span<const std::uint8_t> bytes(data, size);
  const bool closely = thorough(data, size);
  const bool device_time = (data[0] & 1) != 0;
  feed_lidar(type, device_time, closely, bytes);
  if (closely) feed_lidar(type, !device_time, true, bytes);
}

}  // namespace odomcalib::fuzz
