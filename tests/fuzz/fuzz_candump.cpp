// A candump log: every byte accounted for, and every frame the same after writing and reading.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "drivers/can/candump.hpp"

namespace {

using odomcalib::drivers::CanFrame;

bool same(const CanFrame& a, const CanFrame& b) {
  return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.error == b.error &&
         a.length == b.length && a.data == b.data;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace odomcalib::drivers;
  CandumpReader reader({reinterpret_cast<const char*>(data), size});
  while (const auto frame = reader.next()) {
    if (frame->length > 8) std::abort();
    const auto again = parse_candump_line(candump_line(*frame, "can0"));
    if (!again || !same(*again, *frame)) std::abort();
  }
  // Another form of the file is only considered where nothing in it was good.
  const auto problem = reader.problem("fuzz");
  const auto counters = reader.counters();
  if (problem && counters.at("good") != 0) std::abort();
  if (counters.at("bytes_in") != counters.at("good") + counters.at("skipped") + counters.at("buffered"))
    std::abort();
  return 0;
}
