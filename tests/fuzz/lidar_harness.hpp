// Bytes through a lidar driver: the first byte says how the rest is cut into reads. Scans must be finite and
// complete, and every byte accounted for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "drivers/lidar/lidar.hpp"

namespace odomcalib::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

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

/// What a new connection brings is read as if nothing had been before.
inline void start_anew(drivers::Lidar& lidar, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSome = 64;
  lidar.reset();
  (void)lidar.stop_bytes();
  lidar.on_bytes(bytes.first(std::min(bytes.size(), kSome)), 100.0);
  check_accounting(lidar.counters());
}

inline void feed_lidar(const std::string& type, bool device_time, const std::uint8_t* data,
                       std::size_t size) {
  if (size == 0) return;
  drivers::LidarOptions options;
  options.baud = 115'200;
  options.device_time = device_time;
  const auto made = drivers::make_lidar(type, options);
  require(made.ok());
  drivers::Lidar& lidar = *made.value();
  lidar.set_listener([](const drivers::LidarMessage&) {});
  const std::size_t piece = 1U + data[0];
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  unsigned reads = 0;
  for (double now = 0.0; !rest.empty(); now += 0.002) {
    const std::size_t n = std::min(rest.size(), piece);
    lidar.on_bytes(rest.first(n), now);
    rest = rest.subspan(n);
    (void)lidar.take_output();
    for (const auto& scan : lidar.take_scans()) check(scan);
    if (++reads % 8 == 0 || rest.empty())
      check_accounting(lidar.counters());  // most of the time is spent here
  }
  lidar.finish();
  for (const auto& scan : lidar.take_scans()) check(scan);
  (void)lidar.problem();
  (void)lidar.identity();
  (void)lidar.rejected();
  start_anew(lidar, {data, size});
}

/// Both as it arrives from a device and as it is decoded from a file.
inline void feed_lidar(const std::string& type, const std::uint8_t* data, std::size_t size) {
  feed_lidar(type, false, data, size);
  feed_lidar(type, true, data, size);
}

}  // namespace odomcalib::fuzz
