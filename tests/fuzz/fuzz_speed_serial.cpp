// Bytes at every serial base, cut as the first byte says: accounting holds at any moment.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "drivers/base/speed/speed_protocol.hpp"

namespace {

/// What a program says to the device while its bytes come in.
void drive(odomcalib::drivers::SpeedProtocol& protocol, double now) {
  protocol.greet(now);
  protocol.engage();
  protocol.command(1.5, -0.5);
  protocol.stop();
  protocol.release();
  (void)protocol.device_state();
  (void)protocol.identity();
  (void)protocol.reported_timeout_s();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace odomcalib::drivers;
  if (size == 0) return 0;
  const std::size_t piece = 1U + data[0];
  for (const char* name : {"arcos", "ros_arduino"}) {
    Profile profile;
    profile.protocol = name;
    profile.ticks_per_rev = 4096;
    profile.interval_s = 1.0 / 30.0;
    profile.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
    auto protocol = make_speed_protocol(profile);
    if (!protocol.ok()) std::abort();
    protocol.value()->on_connected(57'600);
    double now = 0.0;
    unsigned reads = 0;
    for (std::span<const std::uint8_t> rest(data + 1, size - 1); !rest.empty();) {
      const auto part = rest.first(std::min(piece, rest.size()));
      rest = rest.subspan(part.size());
      now += 0.01;
      if ((data[0] & 1) != 0) protocol.value()->ask(now);
      if (reads % 16 == 1) drive(*protocol.value(), now);
      protocol.value()->on_bytes(part, now);
      (void)protocol.value()->take_counts();
      (void)protocol.value()->take_messages();
      (void)protocol.value()->take_bytes();
      if (++reads % 8 != 0 && !rest.empty()) continue;  // counting takes longer than parsing
      const Counters counters = protocol.value()->counters();
      if (counters.at("bytes_in") != counters.at("good") + counters.at("skipped") + counters.at("buffered"))
        std::abort();
    }
  }
  return 0;
}
