#include "daemon/service/quick_stop.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "daemon/service/base_link.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {

Result<void> quick_stop(const Config& config, const Clock& clock) {
  auto base = BaseLink::create(config.controller_device, config.controller_profile);
  if (!base) return base.error();
  BaseLink& link = base.value();
  bool sent = false;
  const double limit = clock.now() + service::settings::kQuickStopSetUp_s;
  double end = clock.now() + service::settings::kQuickStop_s;
  for (; clock.now() < end; std::this_thread::sleep_for(service::settings::kQuickStopPause)) {
    link.step(clock);
    // Its time begins when the adapter is set up.
    if (link.opening()) end = std::min(limit, clock.now()) + service::settings::kQuickStop_s;
    link.controller().quick_stop(clock.now());
    link.flush();
    sent = sent || (link.connected() && !link.problem());
  }
  if (sent) return {};
  if (link.problem()) return *link.problem();
  return Error{ErrorCode::device, "could not be opened", config.controller_device, ""};
}

}  // namespace odomcalib
