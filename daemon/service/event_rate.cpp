#include "daemon/service/event_rate.hpp"

#include <algorithm>
#include <utility>

#include "daemon/service/settings.hpp"

namespace odomcalib {

std::optional<std::uint64_t> EventRate::admit(const std::string& code, double now) {
  using service::settings::kEventPause_s;
  using service::settings::kEventsAtOnce;
  Kind& kind = kinds_.try_emplace(code, Kind{kEventsAtOnce, now, 0}).first->second;
  const double since = std::exchange(kind.refilled, now);
  kind.allowance = std::min(kEventsAtOnce, kind.allowance + (now - since) / kEventPause_s);
  if (kind.allowance < 1.0) {
    ++kind.left_out;
    return std::nullopt;
  }
  kind.allowance -= 1.0;
  return std::exchange(kind.left_out, 0);
}

}  // namespace odomcalib
