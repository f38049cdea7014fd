// The bound of the daemon's bench: the least that has to be done for each frame on this machine, measured in
// the same run. One thread reads frames from a pseudo-terminal and sends two LCM messages for each, of the
// size of the daemon's counts and odometry; it decodes, integrates, checks and records nothing.
#pragma once

#include <string>
#include <vector>

namespace odomcalib::bench {

struct RelayRun {
  std::vector<double> latencies_ms;  ///< frame to the return of the first message's send
  double cpu_share = 0.0;            ///< of one core
};

RelayRun run_bare_relay(const std::string& lcm_url, double seconds);

}  // namespace odomcalib::bench
