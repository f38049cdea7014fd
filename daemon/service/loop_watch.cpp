#include "daemon/service/loop_watch.hpp"

#include <algorithm>

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

}  // namespace odomcalib
