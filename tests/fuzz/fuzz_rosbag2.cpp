// Recordings of rosbag2 in SQLite: what SQLite makes of damaged pages, and what we make of its rows.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_topics_and_check(std::string("SQLite format 3\0", 16), data, size);
  return 0;
}
