#include "drivers/lidar/common/stamp_line.hpp"

#include <cmath>

#include "drivers/lidar/common/settings.hpp"

namespace odomcalib::drivers {

using namespace lidar;

void StampLine::fit() {
  double n = 0.0, number = 0.0, stamp = 0.0;
  for (const Turn& turn : turns_) {
    n += 1.0;
    number += (static_cast<double>(turn.number) - number) / n;
    stamp += (turn.stamp - stamp) / n;
  }
  double above = 0.0, below = 0.0;
  for (const Turn& turn : turns_) {
    const double d = static_cast<double>(turn.number) - number;
    above += d * (turn.stamp - stamp);
    below += d * d;
  }
  mean_number_ = number;
  mean_stamp_ = stamp;
  // Few coarse stamps tell the period worse than its nominal value does.
  if (turns_.size() >= kTrusted) period_ = above / below;
}

StampLine::Stamp StampLine::add(double stamp, double nominal) {
  const bool trusted = turns_.size() >= kTrusted && std::abs(period_ - nominal) < kMostDeviation * nominal;
  if (!trusted) period_ = nominal;
  const double passed = turns_.empty() ? 0.0 : (stamp - turns_.back().stamp) / period_;
  const double steps = std::round(passed);
  const bool fits = !turns_.empty() && steps >= 1.0 && steps <= static_cast<double>(kMostLost) &&
                    std::abs(passed - steps) <= kMostMisfit * steps;
  if (!fits) {
    turns_.assign(1, {0, stamp});
    return {stamp, 0, true};
  }
  const std::int64_t number = turns_.back().number + static_cast<std::int64_t>(steps);
  turns_.push_back({number, stamp});
  if (turns_.size() > kTurns) turns_.pop_front();
  fit();
  const double t = mean_stamp_ + period_ * (static_cast<double>(number) - mean_number_);
  return {t, static_cast<unsigned>(steps) - 1, false};
}

}  // namespace odomcalib::drivers
