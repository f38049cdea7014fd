#include "drivers/base/motion/stuck_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {

using namespace motion;

StuckWatch::StuckWatch(double ticks_per_rev) : tick_rad_(2.0 * std::numbers::pi / ticks_per_rev) {}

void StuckWatch::begin(double now) {
  rate_ = 0.0;
  commanded_at_ = changed_at_ = now;
  expected_rad_ = 0.0;
  turn_to(0);
}

void StuckWatch::turn_to(int direction) {
  direction_ = direction;
  began_at_ = count_;
  turning_ = false;
  longest_pause_ = 0.0;
}

void StuckWatch::commanded(double rad_s, double now) {
  expected_rad_ += std::abs(rate_) * (now - commanded_at_);
  commanded_at_ = now;
  rate_ = rad_s;
  lowest_ = std::min(lowest_, std::abs(rad_s));
  const int direction = (rad_s > 0.0) - (rad_s < 0.0);
  if (direction != direction_) turn_to(direction);
}

void StuckWatch::counted(std::int64_t forward, double t, double now) {
  sample_t_ = t;
  if (forward == count_) {
    ++same_;
    return;
  }
  if (turning_ && lowest_ >= kFrozenRate_rad_s) longest_pause_ = std::max(longest_pause_, t - changed_t_);
  count_ = forward;
  changed_t_ = t;
  changed_at_ = now;
  expected_rad_ = 0.0;
  lowest_ = std::abs(rate_);
  same_ = 0;
  turning_ = turning_ || direction_ * static_cast<double>(forward - began_at_) * tick_rad_ > kStart_rad;
}

bool StuckWatch::stuck(double now) const { return never_left(now) || froze(); }

bool StuckWatch::never_left(double now) const {
  return expected_rad_ > std::max(kStart_rad, kStart_ticks * tick_rad_) && now - changed_at_ > kStart_s;
}

bool StuckWatch::froze() const {
  const double stood = sample_t_ - changed_t_;
  return turning_ && same_ >= kFrozenReadings && lowest_ >= kFrozenRate_rad_s &&
         stood > std::max(kFrozen_s, kPauses * longest_pause_) && lowest_ * stood > kFrozen_ticks * tick_rad_;
}

}  // namespace odomcalib::drivers
