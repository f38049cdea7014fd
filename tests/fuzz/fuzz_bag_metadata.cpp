// metadata.yaml of a rosbag2 folder: whatever it says, the answer is names of files without folders.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "proto/recording/ros/metadata.hpp"
#include "tests/fuzz/share.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto names = odomcalib::ros::files_listed(text);
  odomcalib::fuzz::require(names.size() <= size);
  for (const auto& name : names) odomcalib::fuzz::require(name.find('/') == std::string::npos);
  return 0;
}
