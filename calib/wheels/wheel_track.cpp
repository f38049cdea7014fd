#include "calib/wheels/wheel_track.hpp"

#include <algorithm>
#include <boost/math/interpolators/makima.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"
#include "calib/wheels/settings.hpp"

namespace odomcalib::calib::wheels {
namespace {

/// Far below zero a count is taken for one of 32 bits that has gone past its largest: a turn of the wheel
/// seldom divides 2^32, and its phase would be lost there.
double without_wrap(std::int64_t count) {
  constexpr std::int64_t kFar = std::int64_t{1} << 30, kWrap = std::int64_t{1} << 32;
  return static_cast<double>(count < -kFar && count >= -2 * kFar ? count + kWrap : count);
}

double angle_at(const WheelTrack& track, const std::vector<double>& angle, double time) {
  const std::size_t k = track.interval_at(time);
  const double share = (time - track.t[k]) / (track.t[k + 1] - track.t[k]);
  return angle[k] + share * (angle[k + 1] - angle[k]);
}

using Cubic = boost::math::interpolators::makima<std::vector<double>>;

constexpr std::size_t kOfCubic = 4;  // samples that a cubic needs

std::vector<double> part_of(const std::vector<double>& all, std::size_t begin, std::size_t end) {
  return {all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end)};
}

double median_period(const WheelTrack& track) {
  std::vector<double> periods = math::differences_of(track.t);
  return periods.empty() ? 0.0 : math::median_of(std::move(periods));
}

void append(WheelTrack& track, double t, double left, double right, int segment) {
  track.t.push_back(t);
  track.left.push_back(left);
  track.right.push_back(right);
  track.segment.push_back(segment);
}

/// Between two samples a cubic may go a little beyond them, and between two that are equal err by rounding: a
/// wheel that stands would seem to reverse.
double within(double from, double to, double value) {
  return std::clamp(value, std::min(from, to), std::max(from, to));
}

/// Samples [begin, end) of one segment without gaps.
void append_refined(const WheelTrack& track, std::size_t begin, std::size_t end, WheelTrack& out) {
  const auto copy = [&](std::size_t k) {
    append(out, track.t[k], track.left[k], track.right[k], track.segment[k]);
  };
  if (end - begin < kOfCubic) {
    for (std::size_t k = begin; k < end; ++k) copy(k);
    return;
  }
  const Cubic left(part_of(track.t, begin, end), part_of(track.left, begin, end));
  const Cubic right(part_of(track.t, begin, end), part_of(track.right, begin, end));
  for (std::size_t k = begin; k + 1 < end; ++k) {
    copy(k);
    const double duration = track.t[k + 1] - track.t[k];
    const int parts = static_cast<int>(std::ceil(duration / settings::kFineInterval_s));
    for (int part = 1; part < parts; ++part) {
      const double t = track.t[k] + duration * part / parts;
      append(out, t, within(track.left[k], track.left[k + 1], left(t)),
             within(track.right[k], track.right[k + 1], right(t)), track.segment[k]);
    }
  }
  copy(end - 1);
}

/// Whether a wheel turned from the sample before to this one.
bool has_turned(const WheelTrack& track, std::size_t k) {
  const double most = static_cast<double>(settings::kStandingCounts) * track.tick_angle;
  return std::abs(track.left[k] - track.left[k - 1]) > most ||
         std::abs(track.right[k] - track.right[k - 1]) > most;
}

/// s: half of the time in which a wheel turned lies in intervals that are no longer. Of samples that come in
/// bursts these are the ones from burst to burst.
double usual_interval(const WheelTrack& track) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < track.t.size(); ++k)
    if (has_turned(track, k)) intervals.push_back(track.t[k] - track.t[k - 1]);
  std::sort(intervals.begin(), intervals.end());
  const double half = 0.5 * std::accumulate(intervals.begin(), intervals.end(), 0.0);
  double time = 0.0;
  for (const double interval : intervals)
    if ((time += interval) >= half) return interval;
  return 0.0;
}

/// A segment of its own after each gap in which a wheel turned: nobody knows when it did.
std::vector<int> segments_of(const WheelTrack& track) {
  const double longest = std::max(settings::kGap_s, settings::kSimilarIntervals * usual_interval(track));
  std::vector<int> segments = track.segment;
  int gaps = 0;
  for (std::size_t k = 1; k < segments.size(); ++k) {
    if (track.t[k] - track.t[k - 1] > longest && has_turned(track, k)) ++gaps;
    segments[k] += gaps;
  }
  return segments;
}

}  // namespace

std::size_t WheelTrack::interval_at(double time) const {
  const auto next = std::upper_bound(t.begin(), t.end(), time);
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - t.begin() - 1, 0));
  return std::min(index, t.size() - 2);
}

Bend WheelTrack::bend(std::size_t interval) const {
  if (interval == 0 || interval + 2 >= t.size() || segment[interval - 1] != segment[interval + 2]) return {};
  const auto duration = [this](std::size_t k) { return t[k + 1] - t[k]; };
  const double own = duration(interval), before = duration(interval - 1), after = duration(interval + 1);
  if (std::max(before, after) > settings::kSimilarIntervals * own ||
      std::min(before, after) * settings::kSimilarIntervals < own)
    return {};
  const double by_rate = own * own / (own + 0.5 * (before + after));
  return {by_rate / before, by_rate / after};
}

bool WheelTrack::covers(double from, double to) const {
  if (empty() || from < t.front() || to > t.back()) return false;
  return segment[interval_at(from)] == segment[std::min(interval_at(to) + 1, t.size() - 1)];
}

WheelMotion motion_between(const WheelTrack& track, double begin, double end,
                           const math::Pose& sensor_motion) {
  return {angle_at(track, track.left, end) - angle_at(track, track.left, begin),
          angle_at(track, track.right, end) - angle_at(track, track.right, begin), sensor_motion};
}

TickAngles::TickAngles(const TickSample& first, double ticks_per_rev)
    : first_(first),
      rad_per_tick_(2.0 * math::kPi / ticks_per_rev),
      left_(std::fmod(without_wrap(first.left), ticks_per_rev)),
      right_(std::fmod(without_wrap(first.right), ticks_per_rev)) {}

void TickAngles::append(const TickSample& sample, WheelTrack& track) const {
  if (!track.t.empty() && !(sample.t > track.t.back())) return;
  track.t.push_back(sample.t);
  track.left.push_back(rad_per_tick_ * (left_ + static_cast<double>(sample.left - first_.left)));
  track.right.push_back(rad_per_tick_ * (right_ + static_cast<double>(sample.right - first_.right)));
  track.segment.push_back(sample.segment);
}

WheelTrack wheel_track_from_ticks(const Recording& recording) {
  WheelTrack track;
  if (recording.ticks.empty()) return track;
  const TickAngles angles(recording.ticks.front(), recording.robot.ticks_per_rev);
  for (const TickSample& sample : recording.ticks) angles.append(sample, track);
  track.tick_angle = angles.tick_angle();
  return track;
}

WheelTrack wheel_track_from_increments(const Recording& recording) {
  WheelTrack track;
  track.t.push_back(0.0);
  track.left.push_back(0.0);
  track.right.push_back(0.0);
  track.segment.push_back(0);
  for (const IncrementSample& sample : recording.increments) {
    track.t.push_back(track.t.back() + sample.duration);
    track.left.push_back(track.left.back() + sample.duration * sample.left_speed);
    track.right.push_back(track.right.back() + sample.duration * sample.right_speed);
    track.segment.push_back(0);
  }
  return track;
}

WheelTrack finely_sampled(WheelTrack track) {
  WheelTrack out;
  out.tick_period = median_period(track);
  out.tick_angle = track.tick_angle;
  track.segment = segments_of(track);
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= track.t.size(); ++k) {
    const bool goes_on = k < track.t.size() && track.segment[k] == track.segment[begin] &&
                         track.t[k] - track.t[k - 1] <= settings::kGap_s;
    if (goes_on) continue;
    append_refined(track, begin, k, out);
    begin = k;
  }
  return out;
}

}  // namespace odomcalib::calib::wheels
