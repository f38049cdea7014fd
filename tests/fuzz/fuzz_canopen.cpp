// A sequence of frames at the controller: 11 bytes each (what, length, time step, data). The controller is
// told to enable, to move and to write now and then, so that every state is met.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/base/cia402/dual_axis.hpp"

namespace {

using odomcalib::drivers::CanFrame;

constexpr const char* kProfile = R"(
[profile]
name = "fuzz"
protocol = "canopen"
[profile.watchdog]
kind = "1016"
[profile.objects]
position_left = "6064:01"
position_right = "6064:02"
speed_left = "60FF:01"
speed_right = "60FF:02"
[profile.ticks]
counts_per_rev = 4096
[profile.speed]
max_rpm = 200
[[profile.tpdo]]
number = 1
map = ["6064:01/32", "6064:02/32"]
[[profile.tpdo]]
number = 2
map = ["6041:00/32"]
[[profile.rpdo]]
number = 1
map = ["6040:00/16"]
[[profile.rpdo]]
number = 2
map = ["60FF:01/32", "60FF:02/32"]
[[profile.parameter]]
quantity = "track_width"
object = "2100:03"
scale = 1e-6
[profile.store]
)";

CanFrame frame_of(std::span<const std::uint8_t> bytes, double now) {
  constexpr std::uint32_t kIds[] = {0x581, 0x701, 0x081, 0x181, 0x281, 0x000, 0x601, 0x080};
  CanFrame frame;
  frame.id = kIds[bytes[0] & 7];
  frame.error = bytes[0] == 0xFF;
  frame.length = static_cast<std::uint8_t>(bytes[1] % 9);
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = bytes[3 + i];
  frame.t = now;
  return frame;
}

/// A server that answers each request well unless the input says otherwise: without it no fuzzer gets past
/// set-up.
void answer_well(odomcalib::drivers::Controller& controller, const CanFrame& request, double now) {
  if (request.id != 0x601 || request.data[0] == 0x80) return;
  CanFrame answer = request;
  answer.id = 0x581;
  answer.t = now;
  answer.data[0] = (request.data[0] & 0xE0) == 0x40 ? 0x43 : 0x60;
  controller.on_frame(answer);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto profile = odomcalib::drivers::parse_profile(kProfile, "fuzz");
  if (!profile.ok()) std::abort();
  odomcalib::drivers::DualAxis controller(profile.value());
  std::span<const std::uint8_t> rest(data, size);
  double now = 1.0;
  for (; rest.size() >= 11; rest = rest.subspan(11)) {
    now += 0.002 * rest[2];
    controller.on_frame(frame_of(rest, now));
    controller.on_time(now);
    const bool well = (rest[0] & 8) != 0;
    for (const CanFrame& sent : controller.take_frames())
      if (well) answer_well(controller, sent, now);
    if ((rest[0] & 16) != 0) controller.enable(now);
    if ((rest[0] & 32) != 0) (void)controller.command(1.0, -1.0, now);
    if ((rest[0] & 64) != 0) (void)controller.start_write_parameters({{"track_width", 0.4}}, now);
    if ((rest[0] & 128) != 0) controller.quick_stop(now);
    for (const auto& tick : controller.take_ticks())
      if (!std::isfinite(tick.t)) std::abort();
    (void)controller.take_events();
    (void)controller.take_job_result();
  }
  return 0;
}
