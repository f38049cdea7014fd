// Bytes of a Lawicel adapter: first byte says how the rest is cut into reads.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "drivers/can/slcan_parser.hpp"

namespace {

using odomcalib::drivers::SlcanItem;
using odomcalib::drivers::SlcanParser;

std::size_t frames_in(const std::string& line) {
  SlcanParser parser;
  std::size_t n = 0;
  for (const auto& item : parser.on_bytes({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}))
    n += item.kind == SlcanItem::Kind::frame ? 1 : 0;
  return n;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1u + data[0];
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  SlcanParser parser;
  for (unsigned reads = 0; !rest.empty();) {
    const std::size_t n = rest.size() < piece ? rest.size() : piece;
    for (const auto& item : parser.on_bytes(rest.first(n))) {
      if (item.frame.length > 8) std::abort();
      if (item.kind == SlcanItem::Kind::frame && frames_in(slcan_line(item.frame)) != 1) std::abort();
    }
    rest = rest.subspan(n);
    if (++reads % 8 != 0 && !rest.empty()) continue;  // counting takes longer than parsing
    const auto counters = parser.counters();
    if (counters.at("bytes_in") != counters.at("good") + counters.at("skipped") + counters.at("buffered"))
      std::abort();
  }
  parser.reset();  // the line was lost and is new
  if (parser.counters().at("buffered") != 0) std::abort();
  return 0;
}
