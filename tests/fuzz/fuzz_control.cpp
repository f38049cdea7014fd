// Control socket: the bytes as a client sends them, cut at places that the first byte chooses.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "proto/control.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace odomcalib::control;
  if (size == 0) return 0;
  const std::size_t step = 1 + data[0];
  std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  FrameDecoder decoder;
  while (!bytes.empty()) {
    const auto part = bytes.substr(0, step);
    decoder.feed(part);
    bytes.remove_prefix(part.size());
    while (const auto frame = decoder.next()) {
      if (const auto call = decode_call(*frame); call.ok())
        if (!decode_call(
                 std::string_view(encode_call(call.value())).substr(0, encode_call(call.value()).size() - 1))
                 .ok())
          std::abort();  // what was accepted must survive its own encoding
      if (const auto reply = decode_reply(*frame); reply.ok()) (void)error_of(reply.value());
    }
  }
  const auto& counters = decoder.counters();
  if (counters.bytes_in != counters.good + counters.skipped + decoder.buffered()) std::abort();
  return 0;
}
