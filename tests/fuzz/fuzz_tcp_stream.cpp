// Segments of one direction of a TCP connection: 4 bytes each say where, what and how many, the data follow.
// Every byte that was given is given out at most once, or counted as repeated.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/decode/tcp_stream_bytes.hpp"
#include "tests/fuzz/share.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using odomcalib::drivers::TcpStreamBytes;
  TcpStreamBytes stream;
  std::span<const std::uint8_t> rest(data, size);
  std::uint64_t given = 0, taken = 0;
  std::uint32_t base = 0xFFFFFF00;  // near the wrap
  const auto take = [&] {
    for (const TcpStreamBytes::Run& run : stream.take()) taken += run.bytes.size();
  };
  while (rest.size() >= 4) {
    const std::uint32_t sequence = base + (rest[1] | static_cast<unsigned>(rest[2]) << 8U);
    const std::size_t n = std::min<std::size_t>(rest[3], rest.size() - 4);
    const auto bytes = rest.subspan(4, n);
    if (rest[0] == 0xFF) base += 0x20000000;  // far away
    if (rest[0] % 8 == 1) stream.on_start(sequence);
    if (rest[0] % 8 == 2) stream.on_acknowledged(sequence);
    if (rest[0] % 8 == 3) take();
    if (rest[0] % 8 >= 4 || rest[0] % 8 == 0) {
      stream.on_segment(sequence, bytes);
      given += n;
      rest = rest.subspan(n);
    }
    rest = rest.subspan(4);
  }
  stream.finish();
  take();
  odomcalib::fuzz::require(taken == stream.bytes() && taken + stream.repeated() == given);
  return 0;
}
