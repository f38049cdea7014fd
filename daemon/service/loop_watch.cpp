#include "daemon/service/loop_watch.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "daemon/service/settings.hpp"

namespace odomcalib {

void LoopWatch::begin(double now, double wait) {
  worst_ = wait_ = 0.0;
  turn_ = {};
  if (turns_ == 0) mark_ = now;
  passed("outside", now);
  wait_ = wait;
}

void LoopWatch::passed(const char* part, double now) {
  const double took = std::max(0.0, now - mark_ - wait_);
  mark_ = now;
  wait_ = 0.0;
  turn_.seconds += took;
  if (took <= worst_) return;
  worst_ = took;
  turn_.part = part;
}

void LoopWatch::end(double now) {
  ++turns_;
  turn_.at = now;
  if (turn_.seconds > ever_.seconds) ever_ = turn_;
  if (turn_.seconds > motion_.seconds) motion_ = turn_;
}

void LoopGuard::hangs(std::size_t line, const std::string& how) {
  hangs_at_ = std::string(names_[line]) + ": " + how;
}

void LoopGuard::polled(std::span<const pollfd> files, int count) {
  if (count < 0 && errno != EINTR) hangs_at_ = std::string("waiting: ") + std::strerror(errno);
  for (Line& line : lines_) line.woke = false;
  if (count <= 0) return;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::size_t line = std::min(i, names_.size() - 1);
    lines_[line].woke = lines_[line].woke || files[i].revents != 0;
    if ((files[i].revents & POLLNVAL) != 0) hangs(line, "its descriptor is not open");
  }
}

void LoopGuard::turned(bool at_once, bool served, std::span<const std::uint64_t> taken) {
  idle_turns_ = at_once && !served ? idle_turns_ + 1 : 0;
  if (idle_turns_ >= service::settings::kMostIdleTurns)
    hangs(names_.size() - 1, "calls wait and none is served");
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    Line& line = lines_[i];
    line.idle_turns = line.woke && line.taken == taken[i] ? line.idle_turns + 1 : 0;
    line.taken = taken[i];
    if (line.idle_turns >= service::settings::kMostIdleTurns) hangs(i, "it wakes the loop and is not served");
  }
}

}  // namespace odomcalib
