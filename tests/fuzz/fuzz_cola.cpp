// Bytes of a lidar of type cola.
#include "tests/fuzz/lidar_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::feed_lidar("cola", data, size);
  return 0;
}
