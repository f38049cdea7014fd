// Control socket: the bytes as a client sends them, cut at places that the first byte chooses.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "proto/control/control.hpp"

namespace {

using namespace odomcalib::control;

std::string without_end(std::string frame) {
  frame.pop_back();
  return frame;
}

/// An accepted call must survive its own encoding, and every answer must be a reply.
void check(const Call& call) {
  if (!decode_call(without_end(encode_call(call))).ok()) std::abort();
  const auto answer = answer_introspection(call, ServiceInfo{});
  if (answer && !decode_reply(without_end(*answer)).ok()) std::abort();
}

void check(const Reply& reply) {
  if (reply.error.empty()) return;
  if (!decode_reply(without_end(encode_error(error_of(reply)))).ok()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t step = 1 + data[0];
  std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  FrameDecoder decoder;
  while (!bytes.empty()) {
    const auto part = bytes.substr(0, step);
    decoder.feed(part);
    bytes.remove_prefix(part.size());
    while (const auto frame = decoder.next()) {
      if (const auto call = decode_call(*frame); call.ok()) check(call.value());
      if (const auto reply = decode_reply(*frame); reply.ok()) check(reply.value());
    }
  }
  const auto& counters = decoder.counters();
  if (counters.bytes_in != counters.good + counters.skipped + decoder.buffered()) std::abort();
  return 0;
}
