#include "drivers/base/motion/wheel_counts.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/base/motion/settings.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers {
namespace {

using Kind = TickUnwrap::Reading::Kind;

TickUnwrap unwrap_of(const Profile& profile) {
  return TickUnwrap(profile.max_rpm / 60.0 * profile.ticks_per_rev, profile.count_bits);
}

}  // namespace

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

const char* to_text(Side side) { return side == Side::left ? "left" : "right"; }

WheelCounts::WheelCounts(const Profile& profile)
    : unwrap_{unwrap_of(profile), unwrap_of(profile)}, sign_{profile.left_sign, profile.right_sign} {}

void WheelCounts::begin_segment() {
  for (TickUnwrap& unwrap : unwrap_) unwrap.forget();
  pairing_.forget();
  ++segment_;
}

WheelCounts::Reading WheelCounts::on_count(Side side, std::int64_t raw, double t) {
  const auto index = static_cast<std::size_t>(side);
  const TickUnwrap::Reading reading = unwrap_[index].on_count(raw, t);
  const Reading out{reading.kind, sign_[index] * reading.total};
  if (reading.kind == Kind::wild) {
    ++wild_;
    return out;
  }
  if (reading.kind == Kind::restarted) {
    pairing_.forget();
    ++segment_;
  }
  if (reading.between) add(side, reading.between->t, sign_[index] * reading.between->total);
  add(side, t, out.forward);
  return out;
}

void WheelCounts::add(Side side, double t, std::int64_t forward) {
  const auto pair = pairing_.add(side, t, forward);
  if (!pair) return;
  if (samples_.size() < motion::kMostQueued)
    samples_.push_back({pair->t, pair->left, pair->right, segment_});
  else
    ++dropped_;
}

void WheelCounts::count_into(Counters& counters) const {
  counters["tick_jumps"] += wild_;
  counters["unpaired_counts"] += pairing_.unpaired();
  counters["events_dropped"] += dropped_;
}

}  // namespace odomcalib::drivers
