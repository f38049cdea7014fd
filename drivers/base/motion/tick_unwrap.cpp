#include "drivers/base/motion/tick_unwrap.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/base/motion/settings.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {

using namespace motion;

void TickUnwrap::forget() {
  last_.reset();
  wild_.reset();
}

std::optional<std::int64_t> TickUnwrap::motion(const Count& from, const Count& to) const {
  const std::int64_t difference =
      sign_extend(static_cast<std::uint64_t>(to.raw) - static_cast<std::uint64_t>(from.raw), bits_);
  const double most = kSpeedMargin * ticks_per_s_ * std::max(to.t - from.t, kShortest_s) + kNoise_ticks;
  return std::abs(static_cast<double>(difference)) > most ? std::nullopt : std::optional(difference);
}

TickUnwrap::Reading TickUnwrap::on_count(std::int64_t count, double t) {
  using Kind = Reading::Kind;
  const Count now{sign_extend(static_cast<std::uint64_t>(count), bits_), t};
  Reading reading;
  if (!last_) {
    if (total_ == 0) total_ = now.raw;
  } else if (const auto way = motion(*last_, now)) {
    if (wild_ && now.t > last_->t) {
      const double share = std::clamp((wild_->t - last_->t) / (now.t - last_->t), 0.0, 1.0);
      reading.between = {wild_->t, total_ + std::llround(share * static_cast<double>(*way))};
    }
    total_ += *way;
  } else if (const auto since_restart = wild_ ? motion(*wild_, now) : std::nullopt) {
    total_ += *since_restart;
    reading.kind = Kind::restarted;
  } else {
    reading.kind = Kind::wild;
  }
  if (reading.kind == Kind::wild) {
    wild_ = now;
  } else {
    wild_.reset();
    last_ = now;
  }
  reading.total = total_;
  return reading;
}

}  // namespace odomcalib::drivers
