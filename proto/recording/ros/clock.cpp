#include "proto/recording/ros/clock.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace odomcalib::ros {
namespace {

// Stamps and times of reception differ by the way of a message through the robot, at most as much as a
// recording may be out of order. Topics whose differences lie farther apart are stamped by clocks that do not
// know each other.
constexpr std::int64_t kClocksApart_ns = 1'000'000'000;
constexpr std::int64_t kStampSecond = 1'000'000'000;  // ns

/// Both times of every message of one topic, whatever its kind.
template <typename Visit>
void each_time(const Topic& topic, Visit visit) {
  for (const auto& one : topic.scans) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.joints) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.yaw_rates) visit(one.stamp_ns, one.received_ns);
  for (const auto& one : topic.poses) visit(one.stamp_ns, one.received_ns);
}

/// The time that a header states; that of reception where it states none.
std::int64_t stamp_or_reception(std::int64_t stamp, std::int64_t received) {
  return stamp == 0 ? received : stamp;
}

/// Upper median of reception less stamp; 0 for a topic without messages. Differences that no clock shows
/// wrap.
std::int64_t lag_of(const Topic& topic) {
  std::vector<std::int64_t> lags;
  each_time(topic, [&](std::int64_t stamp, std::int64_t received) {
    lags.push_back(
        static_cast<std::int64_t>(static_cast<std::uint64_t>(received) -
                                  static_cast<std::uint64_t>(stamp_or_reception(stamp, received))));
  });
  if (lags.empty()) return 0;
  const auto middle = lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 2);
  std::nth_element(lags.begin(), middle, lags.end());
  return *middle;
}

}  // namespace

Clock::Clock(const Chosen& chosen) {
  std::vector<double> lags;
  for (const Topic* topic : chosen.topics)
    if (topic != nullptr) lags.push_back(static_cast<double>(lag_of(*topic)));
  const auto [low, high] = std::minmax_element(lags.begin(), lags.end());
  apart_s_ = lags.empty() ? 0.0 : (*high - *low) / 1e9;
  by_reception_ = apart_s_ > static_cast<double>(kClocksApart_ns) / 1e9;
  for (const Topic* topic : chosen.topics)
    if (topic != nullptr && start_ == 0) set_start(*topic);
}

std::int64_t Clock::time_ns(std::int64_t stamp, std::int64_t received) const {
  return by_reception_ ? received : stamp_or_reception(stamp, received);
}

double Clock::since_start(std::int64_t time) const {
  std::int64_t since = 0;
  if (__builtin_sub_overflow(time, start_, &since)) return std::nan("");
  const std::int64_t seconds = since / kStampSecond, rest = since % kStampSecond;
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

void Clock::set_start(const Topic& topic) {
  each_time(topic, [&](std::int64_t stamp, std::int64_t received) {
    if (start_ == 0) start_ = time_ns(stamp, received) / kStampSecond * kStampSecond;
  });
}

}  // namespace odomcalib::ros
