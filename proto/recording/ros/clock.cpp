#include "proto/recording/ros/clock.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "proto/recording/stamp_units.hpp"

namespace odomcalib::ros {
namespace {

// Stamps and times of reception differ by the way of a message through the robot, at most as much as a
// recording may be out of order. Topics whose differences lie farther apart are stamped by clocks that do not
// know each other.
constexpr std::int64_t kClocksApart_ns = 1'000'000'000;
constexpr std::int64_t kStampSecond = 1'000'000'000;  // ns

// Fewest messages that are judged by their stamps. Chosen.
constexpr std::size_t kFewestStamps = 10;

// ns, by which reception less stamp differs from its median where the clock of the stamps was set meanwhile.
// Chosen: a day is longer than any pause of a recording that is played back, shorter than any date is from
// the time since a computer was started.
constexpr double kSetClock_ns = 86'400e9;
// Messages in a row, and share of all, with such a difference. Chosen: single wild stamps are left out one by
// one.
constexpr std::size_t kFewestInRow = 5;
constexpr double kSetClockShare = 0.1;

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

/// Reception less stamp, in ns. A difference may be beyond what 64 bits hold.
std::vector<double> lags_of(const Topic& topic) {
  std::vector<double> lags;
  each_time(topic, [&](std::int64_t stamp, std::int64_t received) {
    lags.push_back(static_cast<double>(received) - static_cast<double>(stamp_or_reception(stamp, received)));
  });
  return lags;
}

/// Upper median; 0 for a topic without messages.
double lag_of(const Topic& topic) {
  std::vector<double> lags = lags_of(topic);
  if (lags.empty()) return 0.0;
  const auto middle = lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 2);
  std::nth_element(lags.begin(), middle, lags.end());
  return *middle;
}

/// s, by which the clock of the stamps was set while it ran; 0 where it was not.
double clock_set_by(const Topic& topic) {
  const std::vector<double> lags = lags_of(topic);
  const double usual = lag_of(topic);
  std::size_t off = 0, in_row = 0, longest = 0;
  double farthest = 0.0;
  for (const double lag : lags) {
    const double apart = std::abs(lag - usual);
    in_row = apart > kSetClock_ns ? in_row + 1 : 0;
    off += apart > kSetClock_ns ? 1 : 0;
    longest = std::max(longest, in_row);
    farthest = std::max(farthest, apart);
  }
  const bool many =
      off >= kFewestInRow && static_cast<double>(off) > kSetClockShare * static_cast<double>(lags.size());
  return longest >= kFewestInRow || many ? farthest / 1e9 : 0.0;
}

bool same(const Scan& a, const Scan& b) { return a.ranges == b.ranges; }
bool same(const JointValues& a, const JointValues& b) {
  return a.positions == b.positions && a.velocities == b.velocities;
}
bool same(double a, double b) { return a == b; }
bool same(const PoseSample& a, const PoseSample& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

/// Messages of one publisher whose value is not that of the one before, and how many of them have its time.
struct Repeated {
  std::size_t repeated = 0, all = 0;
  [[nodiscard]] bool lost_digits() const {
    return all >= kFewestStamps && static_cast<double>(repeated) > kRepeatedShare * static_cast<double>(all);
  }
};

/// @param publisher the list of names or the frame of a message: several publishers may share their stamps
/// @param time 0: not set
template <typename Value, typename Publisher, typename Time>
void count_repeated(const std::vector<Stamped<Value>>& messages, Publisher publisher, Time time,
                    Repeated& found) {
  std::map<std::size_t, const Stamped<Value>*> last;
  for (const auto& one : messages) {
    const Stamped<Value>*& before = last[publisher(one)];
    if (before != nullptr && !same(before->value, one.value) && time(one) != 0) {
      ++found.all;
      found.repeated += time(*before) == time(one) ? 1 : 0;
    }
    before = &one;
  }
}

template <typename Time>
Repeated repeated_in(const Topic& topic, Time time) {
  Repeated found;
  const auto by_frames = [](const auto& one) { return one.frames; };
  count_repeated(topic.scans, by_frames, time, found);
  count_repeated(
      topic.joints, [](const auto& one) { return one.value.names; }, time, found);
  count_repeated(topic.yaw_rates, by_frames, time, found);
  count_repeated(topic.poses, by_frames, time, found);
  return found;
}

template <typename Value>
std::size_t fit_missing(std::vector<Stamped<Value>>& messages) {
  const auto is_set = [](const auto& one) { return one.stamp_ns != 0; };
  const auto first = std::find_if(messages.begin(), messages.end(), is_set);
  const auto unset = messages.size() - static_cast<std::size_t>(std::count_if(first, messages.end(), is_set));
  if (2 * unset >= messages.size()) return 0;
  std::size_t fitted = 0;
  Stamped<Value>* near = &*first;
  for (auto& one : messages) {
    std::int64_t apart = 0, stamp = 0;
    if (is_set(one)) {
      near = &one;
    } else if (!__builtin_sub_overflow(one.received_ns, near->received_ns, &apart) &&
               !__builtin_add_overflow(near->stamp_ns, apart, &stamp)) {
      one.stamp_ns = stamp == 0 ? 1 : stamp;
      ++fitted;
    }
  }
  return fitted;
}

}  // namespace

std::size_t fit_missing_stamps(Topic& topic) {
  return fit_missing(topic.scans) + fit_missing(topic.joints) + fit_missing(topic.yaw_rates) +
         fit_missing(topic.poses);
}

Clock::Clock(const Chosen& chosen) {
  const std::vector<Topic*> topics = taken_topics(chosen);
  std::vector<double> lags;
  std::string reason;
  bool reception_is_sound = true;
  for (const Topic* topic : topics) {
    lags.push_back(lag_of(*topic));
    const Repeated stamps = repeated_in(*topic, [](const auto& one) { return one.stamp_ns; });
    const Repeated reception = repeated_in(*topic, [](const auto& one) { return one.received_ns; });
    reception_is_sound = reception_is_sound && !reception.lost_digits();
    const std::string of = "the stamps of " + topic->header.name;
    if (const double set_by = clock_set_by(*topic); set_by > 0.0)
      reason = of + " jump by " + std::to_string(std::llround(set_by)) + " s, their clock was set meanwhile";
    else if (stamps.lost_digits())
      reason = of + " have lost their last digits: " + std::to_string(stamps.repeated) + " of " +
               std::to_string(stamps.all) + " are that of the message before";
  }
  const auto [low, high] = std::minmax_element(lags.begin(), lags.end());
  const double apart = lags.empty() ? 0.0 : *high - *low;
  if (reason.empty() && apart > static_cast<double>(kClocksApart_ns))
    reason = "the stamps of these topics lie " + std::to_string(apart / 1e9) +
             " s apart, they come from different clocks";
  judge(reason, reception_is_sound);
  for (const Topic* topic : topics)
    if (start_ == 0) set_start(*topic);
}

double Clock::start() const { return static_cast<double>(start_ / kStampSecond); }

void Clock::judge(const std::string& reason, bool reception_is_sound) {
  if (reason.empty()) return;
  by_reception_ = reception_is_sound;
  remark_ = by_reception_ ? "times of reception: " + reason
                          : reason + "; the times of reception are no better, the stamps are taken";
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
