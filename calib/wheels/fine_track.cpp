#include "calib/wheels/fine_track.hpp"

#include <algorithm>
#include <boost/math/interpolators/makima.hpp>
#include <cmath>
#include <utility>

#include "calib/math/median.hpp"
#include "calib/wheels/settings.hpp"

namespace odomcalib::calib::wheels {
namespace {

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

}  // namespace

WheelTrack finely_sampled(const WheelTrack& track) {
  WheelTrack out;
  out.tick_period = median_period(track);
  out.tick_angle = track.tick_angle;
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
