// A sequence of frames at a CAN protocol of wheel speeds: 16 bytes each (kind, length, identifier, 8 data
// bytes, what the program says to the device, and in the first record which protocol). Inputs looked at
// thoroughly are seen by all protocols; each finds its own among the frames.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "drivers/base/speed/speed_protocol.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using namespace odomcalib::drivers;

Profile profile_of(const char* protocol, bool pulses) {
  Profile profile;
  profile.protocol = protocol;
  profile.node = 0x7F;
  profile.ticks_per_rev = 4096;
  profile.max_rpm = 200;
  profile.count_source = pulses ? (profile.protocol == "odrive" ? "count" : "pulses") : "estimates";
  profile.count_bits = 24;
  profile.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  return profile;
}

CanFrame frame_of(std::span<const std::uint8_t> bytes, double t) {
  CanFrame frame;
  frame.t = t;
  frame.extended = (bytes[0] & 1) != 0;
  frame.remote = (bytes[0] & 2) != 0;
  frame.length = static_cast<std::uint8_t>(bytes[1] % 9);
  for (std::size_t i = 0; i < 4; ++i) frame.id = frame.id << 8 | bytes[2 + i];
  frame.id &= frame.extended ? 0x1FFFFFFF : 0x7FF;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = bytes[6 + i];
  return frame;
}

void use(SpeedProtocol& protocol, std::uint8_t wish, double now) {
  if ((wish & 1) != 0) protocol.greet(now);
  if ((wish & 2) != 0) protocol.ask(now);
  if ((wish & 4) != 0) protocol.engage();
  if ((wish & 8) != 0) protocol.command(1.5, -0.5);
  if ((wish & 16) != 0) protocol.stop();
  if ((wish & 32) != 0) protocol.release();
  (void)protocol.device_state();
  (void)protocol.identity();
}

void check(SpeedProtocol& protocol) {
  for (const CanFrame& frame : protocol.take_frames())
    if (frame.length > 8) std::abort();
  (void)protocol.take_counts();
  for (const DeviceMessage& message : protocol.take_messages())
    for (const MessageField& field : message.fields)
      if (!std::isfinite(field.number)) std::abort();
  const Counters counters = protocol.counters();
  if (counters.at("frames_in") !=
      counters.at("frames_used") + counters.at("bad_frames") + counters.at("other_frames"))
    std::abort();
}

constexpr const char* kProtocols[] = {"agilex", "odrive", "segway", "vesc"};
constexpr std::size_t kRecord = 16;

/// @param which protocol (two bits) and source of counts (one bit)
void feed(unsigned which, std::span<const std::uint8_t> rest) {
  const auto protocol = make_speed_protocol(profile_of(kProtocols[which & 3U], (which & 4U) != 0));
  if (!protocol.ok()) std::abort();
  double t = 0.0;
  for (; rest.size() >= kRecord; rest = rest.subspan(kRecord)) {
    protocol.value()->on_frame(frame_of(rest, t += 0.001));
    use(*protocol.value(), rest[14], t);
  }
  check(*protocol.value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < kRecord) return 0;
  const bool all = odomcalib::fuzz::thorough(data, size);
  for (unsigned which = 0; which < 8; ++which)
    if (all || which == (data[kRecord - 1] & 7U)) feed(which, {data, size});
  return 0;
}
