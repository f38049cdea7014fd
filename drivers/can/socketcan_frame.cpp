#include "drivers/can/socketcan_frame.hpp"

#include <algorithm>

namespace odomcalib::drivers {

std::optional<CanFrame> from_kernel(const can_frame& raw, std::size_t size) {
  if (size != CAN_MTU || raw.can_dlc > CAN_MAX_DLEN) return std::nullopt;
  CanFrame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = raw.can_dlc;
  if (!frame.remote) std::copy_n(std::begin(raw.data), frame.length, frame.data.begin());
  return frame;
}

can_frame to_kernel(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  if (!frame.remote) std::copy_n(frame.data.begin(), raw.can_dlc, std::begin(raw.data));
  return raw;
}

}  // namespace odomcalib::drivers
