#include "daemon/service/quick_stop.hpp"

#include <chrono>
#include <thread>

#include "daemon/service/base_link.hpp"

namespace odomcalib {

Result<void> quick_stop(const Config& config, const Clock& clock) {
  constexpr double kDuration = 0.5;  // s; identity of a drive: four answers, 50 ms each at worst
  constexpr auto kPause = std::chrono::milliseconds(5);
  auto base = BaseLink::create(config.controller_device, config.controller_profile);
  if (!base) return base.error();
  BaseLink& link = base.value();
  bool sent = false;
  for (const double end = clock.now() + kDuration; clock.now() < end; std::this_thread::sleep_for(kPause)) {
    link.step(clock);
    link.controller().quick_stop(clock.now());
    link.flush();
    sent = sent || (link.connected() && !link.problem());
  }
  if (sent) return {};
  if (link.problem()) return *link.problem();
  return Error{ErrorCode::device, "could not be opened", config.controller_device, ""};
}

}  // namespace odomcalib
