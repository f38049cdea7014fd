// JSON Lines behind a valid robot line.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_and_check(
      "{\"type\":\"robot\",\"wheel_diameter\":0.1,\"track_width\":0.3,\"ticks_per_rev\":1000}\n", data, size);
  return 0;
}
