// Bytes of a Lawicel adapter: first byte says how the rest is cut into reads.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "drivers/can/slcan_parser.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using odomcalib::drivers::SlcanItem;
using odomcalib::drivers::SlcanParser;
using odomcalib::fuzz::require;

std::size_t frames_in(const std::string& line) {
  SlcanParser parser;
  std::size_t n = 0;
  for (const auto& item : parser.on_bytes({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}))
    n += item.kind == SlcanItem::Kind::frame ? 1 : 0;
  return n;
}

void check(const SlcanItem& item, bool closely) {
  require(item.frame.length <= 8);
  if (closely && item.kind == SlcanItem::Kind::frame) require(frames_in(slcan_line(item.frame)) == 1);
}

void check_accounting(const SlcanParser& parser) {
  const auto counters = parser.counters();
  require(counters.at("bytes_in") == counters.at("good") + counters.at("skipped") + counters.at("buffered"));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool closely = odomcalib::fuzz::thorough(data, size);
  const std::size_t piece = 1u + data[0];
  SlcanParser parser;
  for (std::span<const std::uint8_t> rest(data + 1, size - 1); !rest.empty();) {
    const std::size_t n = rest.size() < piece ? rest.size() : piece;
    for (const auto& item : parser.on_bytes(rest.first(n))) check(item, closely);
    rest = rest.subspan(n);
    if (closely) check_accounting(parser);
  }
  check_accounting(parser);
  if (!closely) return 0;
  parser.reset();  // the line was lost and is new
  require(parser.counters().at("buffered") == 0);
  return 0;
}
