#include "daemon/service/parts/link_watch.hpp"

#include <utility>

namespace odomcalib {

std::optional<LinkWatch::News> LinkWatch::look(const std::string& device, bool connected,
                                               const std::optional<Error>& problem) {
  const bool was_connected = std::exchange(connected_, connected);
  const std::string now = problem ? problem->text() : "";
  const std::string before = std::exchange(problem_, now);
  if (was_connected && !connected) return News{false, device + " is lost" + (now.empty() ? "" : ": " + now)};
  if (!now.empty() && now != before) return News{false, device + ": " + now};
  if (!connected) return std::nullopt;
  if (!was_connected) return News{true, device + " is connected"};
  if (!before.empty() && now.empty()) return News{true, device + " works again"};
  return std::nullopt;
}

}  // namespace odomcalib
