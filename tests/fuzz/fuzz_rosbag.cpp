// Bags of ROS 1, format 2.0.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_topics_and_check("#ROSBAG V2.0\n", data, size);
  return 0;
}
