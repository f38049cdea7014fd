// Bytes at a serial base; the first byte says which, and how the rest is cut. Inputs looked at thoroughly are
// seen by all, and accounting is checked at every moment.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "drivers/base/speed/speed_protocol.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using namespace odomcalib::drivers;
using odomcalib::fuzz::require;

Profile profile_of(const char* name) {
  Profile profile;
  profile.protocol = name;
  profile.ticks_per_rev = 4096;
  profile.interval_s = 1.0 / 30.0;
  profile.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  return profile;
}

/// Calls that a program makes while the device's bytes come in.
void drive(SpeedProtocol& protocol, double now) {
  protocol.greet(now);
  protocol.engage();
  protocol.command(1.5, -0.5);
  protocol.stop();
  protocol.release();
  (void)protocol.device_state();
  (void)protocol.identity();
  (void)protocol.reported_timeout_s();
}

void take_all(SpeedProtocol& protocol) {
  (void)protocol.take_counts();
  (void)protocol.take_messages();
  (void)protocol.take_bytes();
}

void check_accounting(const SpeedProtocol& protocol) {
  const Counters counters = protocol.counters();
  require(counters.at("bytes_in") == counters.at("good") + counters.at("skipped") + counters.at("buffered"));
}

void feed(const char* name, bool closely, std::span<const std::uint8_t> bytes) {
  const auto made = make_speed_protocol(profile_of(name));
  require(made.ok());
  SpeedProtocol& protocol = *made.value();
  protocol.on_connected(57'600);
  const std::size_t piece = 1U + bytes[0];
  unsigned reads = 0;
  for (auto rest = bytes.subspan(1); !rest.empty(); ++reads) {
    const auto part = rest.first(std::min(piece, rest.size()));
    const double now = 0.01 * (1.0 + reads);
    rest = rest.subspan(part.size());
    if ((bytes[0] & 1) != 0) protocol.ask(now);
    if (reads % 16 == 1) drive(protocol, now);
    protocol.on_bytes(part, now);
    take_all(protocol);
    if (closely) check_accounting(protocol);
  }
  check_accounting(protocol);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool all = odomcalib::fuzz::thorough(data, size);
  const bool second = (data[0] & 2) != 0;
  if (all || !second) feed("arcos", all, {data, size});
  if (all || second) feed("ros_arduino", all, {data, size});
  return 0;
}
