// An SDO client in conversation with a node that answers anything. First byte: read or write, and how many
// bytes; then 10 bytes a frame (time step, length, data). The answers name our object, or no fuzzer gets past
// the first.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/base/canopen/pdo.hpp"
#include "drivers/base/canopen/sdo_client.hpp"

namespace {

using namespace odomcalib::drivers;
using namespace odomcalib::drivers::canopen;

constexpr std::uint8_t kNode = 1;

SdoRequest request_of(std::uint8_t what) {
  SdoRequest request;
  request.object = {0x2100, 1};
  request.write = (what & 1) != 0;
  if (request.write) request.data.assign(1U + (what >> 1U) % 32U, what);
  request.retries = what % 3;
  return request;
}

CanFrame frame_of(std::span<const std::uint8_t> bytes, double now) {
  CanFrame frame;
  frame.id = 0x580 + kNode;
  frame.t = now;
  frame.length = static_cast<std::uint8_t>(bytes[1] > 8 ? 8 : bytes[1]);
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = bytes[2 + i];
  return frame;
}

void require(bool holds) {
  if (!holds) std::abort();
}

/// The same frame as process data of every predefined identifier.
void read_as_process_data(const CanFrame& frame, std::uint32_t id) {
  const auto pdo = predefined_pdo(id);
  if (!pdo) return;
  CanFrame copy = frame;
  for (const PdoEntry& entry : pdo->entries)
    if (const auto number = unpack(*pdo, frame, entry.object)) {
      pack(*pdo, copy, entry.object, *number);
      require(unpack(*pdo, copy, entry.object) == number);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  SdoClient client(kNode);
  double now = 0.0;
  require(client.start(request_of(data[0]), now));
  for (std::span rest(data + 1, size - 1); rest.size() >= 10; rest = rest.subspan(10)) {
    now += 0.002 * rest[0];
    const CanFrame frame = frame_of(rest, now);
    (void)client.on_frame(frame, now);
    client.on_time(now);
    for (const CanFrame& sent : client.take_frames()) require(sent.id == 0x600U + kNode && sent.length == 8);
    if (const auto result = client.take_result()) {
      require(!client.busy() && result->data.size() <= kSdoMostBytes);
      (void)client.start(request_of(rest[1]), now);
    }
    read_as_process_data(frame, 0x180U + 0x80U * (rest[0] % 9U) + kNode);
  }
  require(client.counters().at("sdo_transfers") < 1 + size);
  return 0;
}
