// Censi's tuple files.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_and_check("{\"T\":1,\"phi_l\":1,\"phi_r\":1,\"sm\":[0,0,0]}", data, size);
  return 0;
}
