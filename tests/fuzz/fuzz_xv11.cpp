// Bytes of a lidar of type xv11.
#include "tests/fuzz/lidar_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::feed_lidar("xv11", data, size);
  return 0;
}
