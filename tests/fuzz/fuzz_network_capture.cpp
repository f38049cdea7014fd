// A network capture: libpcap's reading of the file, ours of its packets, and the streams put together.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/decode/network_capture.hpp"
#include "tests/fuzz/share.hpp"

using odomcalib::drivers::CapturedStream;
using odomcalib::drivers::TcpStreamBytes;
using odomcalib::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view file(reinterpret_cast<const char*>(data), size);
  (void)odomcalib::drivers::is_network_capture(file);
  auto read = odomcalib::drivers::read_network_capture(file, "fuzz");
  if (!read) return 0;
  for (CapturedStream& one : read.value().streams) {
    std::uint64_t bytes = 0;
    for (const TcpStreamBytes::Run& run : one.stream.take()) {
      require(!run.bytes.empty());
      bytes += run.bytes.size();
    }
    require(bytes == one.stream.bytes() && bytes <= size);
  }
  return 0;
}
