#include "drivers/sample_clock.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/settings.hpp"

namespace odomcalib::drivers {
void SampleClock::reset() {
  running_ = false;
  rate_ = 1.0;
}

void SampleClock::start(double arrival) {
  running_ = true;
  t_ = device_time_ ? 0.0 : arrival;
  window_ = 0.0;
}

void SampleClock::learn(double late, double nominal) {
  least_late_ = window_ > 0.0 ? std::min(least_late_, late) : late;
  window_ += nominal;
  if (window_ < kWindow_s) return;
  t_ += least_late_;
  rate_ = std::clamp(rate_ + kRateGain * least_late_ / window_, 1.0 / kMostRate, kMostRate);
  window_ = 0.0;
}

SampleClock::Stamp SampleClock::on_packet(double nominal, double arrival) {
  if (!running_) {
    start(arrival);
    return {t_, false};
  }
  t_ += rate_ * nominal;
  if (device_time_) return {t_, true};
  const double late = arrival - t_;
  if (std::abs(late) > kHole_s) {
    start(arrival);
    return {t_, false};
  }
  learn(late, nominal);
  return {std::min(t_, arrival), true};
}

}  // namespace odomcalib::drivers
