// LCM event logs.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_and_check(std::string("\xED\xA1\xDA\x01", 4), data, size);
  return 0;
}
