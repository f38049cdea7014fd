#include "drivers/device_clock.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/settings.hpp"

namespace odomcalib::drivers {

void DeviceClock::reset() { last_count_.reset(); }

void DeviceClock::unwrap(std::uint64_t count, double arrival) {
  const std::uint64_t steps = (count + modulus_ - *last_count_) % modulus_;
  const double modulus_s = static_cast<double>(modulus_) * tick_s_;
  const double step = static_cast<double>(steps) * tick_s_;
  // Whole turns that passed unseen, e.g. while the port was unplugged.
  const double missed = device_time_ ? 0.0 : std::round((arrival - last_arrival_ - step) / modulus_s);
  device_s_ += step + std::max(0.0, missed) * modulus_s;
}

double DeviceClock::to_host(std::uint64_t count, double arrival) {
  const bool first = !last_count_.has_value();
  if (!first) unwrap(count, arrival);
  if (first) device_s_ = static_cast<double>(count) * tick_s_;
  last_count_ = count;
  last_arrival_ = arrival;
  if (device_time_) return device_s_;
  const double delay = arrival - device_s_;
  if (first || std::abs(delay - offset_) > kRestarted_s) {
    offset_ = delay;
  } else {
    offset_ = std::min(delay, offset_ + kDrift * std::max(0.0, device_s_ - last_device_s_));
  }
  last_device_s_ = device_s_;
  return device_s_ + offset_;
}

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
