// Bytes of a lidar of type rplidar.
#include "tests/fuzz/lidar_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::feed_lidar("rplidar", data, size);
  return 0;
}
