#include "daemon/safety/freshness.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {
namespace {

std::uint64_t fingerprint_of(const Scan& scan) {
  const auto* bytes = reinterpret_cast<const char*>(scan.ranges.data());
  return std::hash<std::string_view>{}({bytes, scan.ranges.size() * sizeof(float)});
}

bool has_reading(const Scan& scan) {
  return std::any_of(scan.ranges.begin(), scan.ranges.end(), [](float range) { return range > 0.0F; });
}

}  // namespace

void ScanFreshness::seen(const Scan& scan, double now) {
  const std::uint64_t fingerprint = fingerprint_of(scan);
  frozen_ = last_ && fingerprint == fingerprint_;
  fingerprint_ = fingerprint;
  empty_ = !has_reading(scan);
  if (!frozen_ && !empty_) last_ = now;
}

std::optional<std::string> ScanFreshness::stale(double now) const {
  if (last_ && now - *last_ <= kScanTimeout) return std::nullopt;
  if (empty_) return "the lidar sees nothing: no beam has an echo";
  if (!last_) return "no scan yet";
  return frozen_ ? "lidar repeats the same scan" : "no scan for more than 250 ms";
}

void EncoderFreshness::seen(const TickSample& sample, double now) {
  const std::array counts{sample.left, sample.right};
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    if (!last_ || wheels_.at(i).count != counts.at(i)) wheels_.at(i).changed = now;
    wheels_.at(i).count = counts.at(i);
  }
  last_ = now;
}

void EncoderFreshness::tell(Wheel& wheel, double rate, double now) {
  const bool turning = std::abs(rate) > settings::kTurning_rad_s;
  if (!turning)
    wheel.told_since = -1.0;
  else if (wheel.told_since < 0.0)
    wheel.told_since = now;
}

void EncoderFreshness::commanded(double left, double right, double now) {
  tell(wheels_[0], left, now);
  tell(wheels_[1], right, now);
}

bool EncoderFreshness::frozen(const Wheel& wheel, double now) {
  const bool told = wheel.told_since >= 0.0 && now - wheel.told_since > settings::kBreakAway_s;
  return told && now - wheel.changed > settings::kFrozen_s;
}

std::optional<std::string> EncoderFreshness::stale(double now) const {
  if (!last_) return "no encoder counts yet";
  if (now - *last_ > kEncoderTimeout) return "no encoder counts for more than 100 ms";
  if (frozen(wheels_[0], now)) return "left wheel is commanded to turn and its count does not change";
  if (frozen(wheels_[1], now)) return "right wheel is commanded to turn and its count does not change";
  return std::nullopt;
}

}  // namespace odomcalib::safety
