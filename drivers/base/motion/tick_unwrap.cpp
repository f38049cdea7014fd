#include "drivers/base/motion/tick_unwrap.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/bytes.hpp"
#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {
namespace {

using namespace motion;

}  // namespace

TickUnwrap::Reading TickUnwrap::on_count(std::int64_t count, double t) {
  const std::int64_t raw = sign_extend(static_cast<std::uint64_t>(count), bits_);
  Reading reading;
  if (!last_) {
    if (total_ == 0) total_ = raw;
  } else {
    const std::int64_t difference =
        sign_extend(static_cast<std::uint64_t>(raw) - static_cast<std::uint64_t>(*last_), bits_);
    const double most = kSpeedMargin * ticks_per_s_ * std::max(t - last_t_, kShortest_s) + kNoise_ticks;
    reading.jumped = std::abs(static_cast<double>(difference)) > most;
    if (!reading.jumped) total_ += difference;
  }
  last_ = raw;
  last_t_ = t;
  reading.total = total_;
  return reading;
}

}  // namespace odomcalib::drivers
