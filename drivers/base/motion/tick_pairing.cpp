#include "drivers/base/motion/tick_pairing.hpp"

#include <cmath>

#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {

using namespace motion;

void TickPairing::forget() {
  waiting_left_.reset();
  last_right_.reset();
}

std::optional<TickPairing::Pair> TickPairing::pair_between(const Count& before, const Count& after) {
  const Count left = *waiting_left_;
  if (left.t < before.t - kSameInstant_s || after.t - before.t > kLongestGap_s) {
    waiting_left_.reset();
    ++unpaired_;
    return std::nullopt;
  }
  if (left.t > after.t + kSameInstant_s) return std::nullopt;
  waiting_left_.reset();
  const double share = after.t > before.t ? (left.t - before.t) / (after.t - before.t) : 1.0;
  const double right = static_cast<double>(after.value - before.value) * share;
  return Pair{left.t, left.value, before.value + std::llround(right)};
}

std::optional<TickPairing::Pair> TickPairing::add(Side side, double t, std::int64_t count) {
  const Count now{t, count};
  if (side == Side::left) {
    if (waiting_left_) ++unpaired_;
    waiting_left_ = now;
    const bool same = last_right_ && std::abs(last_right_->t - t) <= kSameInstant_s;
    return same ? pair_between(*last_right_, *last_right_) : std::nullopt;
  }
  std::optional<Pair> pair;
  if (waiting_left_) {
    const bool same = std::abs(waiting_left_->t - t) <= kSameInstant_s;
    if (same || last_right_) pair = pair_between(same ? now : *last_right_, now);
  }
  last_right_ = now;
  return pair;
}

}  // namespace odomcalib::drivers
