// Single LCM messages, as they arrive over UDP.
#include <cstdint>
#include <string_view>

#include "proto/wire/messages.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace odomcalib::messages;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)decode_robot(bytes);
  (void)decode_ticks(bytes);
  (void)decode_scan(bytes);
  (void)decode_pose(bytes);
  (void)decode_gyro(bytes);
  (void)decode_event(bytes);
  (void)decode_json(bytes);
  return 0;
}
