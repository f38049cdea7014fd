// Recordings of any form, as a user names them: recognition, gzip, all readers.
#include "tests/fuzz/recording_harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odomcalib::fuzz::read_and_check("", data, size);
  return 0;
}
