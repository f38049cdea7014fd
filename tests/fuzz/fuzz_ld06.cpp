// Bytes of an LD06: first byte says how the rest is cut into reads.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/lidar/ld06/ld06.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1u + data[0];
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  odomcalib::drivers::Ld06 lidar(230400);
  for (double now = 0.0; !rest.empty(); now += 0.002) {
    const std::size_t n = rest.size() < piece ? rest.size() : piece;
    lidar.on_bytes(rest.first(n), now);
    rest = rest.subspan(n);
    for (const auto& scan : lidar.take_scans())
      if (!std::isfinite(scan.t) || scan.angles.size() != scan.ranges.size()) std::abort();
    const auto counters = lidar.counters();
    if (counters.at("bytes_in") != counters.at("good") + counters.at("skipped") + counters.at("buffered"))
      std::abort();
  }
  return 0;
}
