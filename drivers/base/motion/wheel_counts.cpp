#include "drivers/base/motion/wheel_counts.hpp"

#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {
namespace {

using Kind = TickUnwrap::Reading::Kind;

TickUnwrap unwrap_of(const Profile& profile) {
  return TickUnwrap(profile.max_rpm / 60.0 * profile.ticks_per_rev, profile.count_bits);
}

}  // namespace

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
