// Bytes of a Lawicel adapter: first byte says how the rest is cut into reads.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/can/slcan_parser.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1u + data[0];
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  odomcalib::drivers::SlcanParser parser;
  while (!rest.empty()) {
    const std::size_t n = rest.size() < piece ? rest.size() : piece;
    for (const auto& item : parser.on_bytes(rest.first(n)))
      if (item.frame.length > 8) std::abort();
    rest = rest.subspan(n);
    const auto counters = parser.counters();
    if (counters.at("bytes_in") != counters.at("good") + counters.at("skipped") + counters.at("buffered"))
      std::abort();
  }
  return 0;
}
