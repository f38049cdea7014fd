#include "daemon/service/loop_guard.hpp"

#include <algorithm>

#include "daemon/service/settings.hpp"

namespace odomcalib {

void LoopGuard::polled(std::span<const pollfd> files) {
  for (std::size_t i = 0; i < files.size(); ++i)
    if ((files[i].revents & POLLNVAL) != 0)
      hangs_at_ = std::string(names_[std::min(i, names_.size() - 1)]) + ": its descriptor is not open";
}

void LoopGuard::turned(bool at_once, bool served) {
  idle_turns_ = at_once && !served ? idle_turns_ + 1 : 0;
  if (idle_turns_ >= service::settings::kMostIdleTurns)
    hangs_at_ = std::string(names_.back()) + ": calls wait and none is served";
}

}  // namespace odomcalib
