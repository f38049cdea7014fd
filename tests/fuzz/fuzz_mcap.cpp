// MCAP recordings.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_topics_and_check(std::string("\x89MCAP0\r\n", 8), data, size);
  return 0;
}
