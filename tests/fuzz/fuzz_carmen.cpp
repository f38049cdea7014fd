// CARMEN logs.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_and_check("PARAM a b 0 c 0\n", data, size);
  return 0;
}
