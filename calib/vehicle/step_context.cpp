#include "calib/vehicle/step_context.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/vehicle/drive_history.hpp"
#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {
namespace {

/// Least-squares parabola through (t, values) around `centre` within the smoothing window: slope and
/// curvature.
struct LocalDerivatives {
  double first = 0.0;
  double second = 0.0;
};

LocalDerivatives local_derivatives(const std::vector<double>& t, const std::vector<double>& values,
                                   std::size_t low, std::size_t high, double centre) {
  // Normal equations of c0 + c1 u + c2 u^2 with u = (t - centre) / window, solved by Cramer's rule on sums.
  double s[5] = {};
  double b[3] = {};
  for (std::size_t k = low; k <= high; ++k) {
    const double u = (t[k] - centre) / settings::kSmoothing_s;
    const double y = values[k] - values[low];
    double power = 1.0;
    for (int j = 0; j < 5; ++j, power *= u) {
      s[j] += power;
      if (j < 3) b[j] += power * y;
    }
  }
  Eigen::Matrix3d normal;
  normal << s[0], s[1], s[2], s[1], s[2], s[3], s[2], s[3], s[4];
  const double determinant = normal.determinant();
  if (high - low >= 3 && std::abs(determinant) > 1e-9 * std::pow(s[0], 3)) {
    const Eigen::Vector3d c = normal.inverse() * Eigen::Vector3d(b[0], b[1], b[2]);
    return {c(1) / settings::kSmoothing_s, 2.0 * c(2) / (settings::kSmoothing_s * settings::kSmoothing_s)};
  }
  const double duration = t[high] - t[low];
  return {duration > 0.0 ? (values[high] - values[low]) / duration : 0.0, 0.0};
}

struct Window {
  std::size_t low = 0;
  std::size_t high = 0;
};

/// Samples within half a smoothing window of `centre`, at least interval k itself, never across a segment.
Window window_around(const wheels::WheelTrack& track, std::size_t k, Window window, double centre,
                     double duration) {
  while (track.t[window.low] < centre - duration / 2.0 && window.low < k) ++window.low;
  window.high = std::max(window.high, k + 1);
  while (window.high + 1 < track.t.size() && track.t[window.high + 1] <= centre + duration / 2.0)
    ++window.high;
  while (track.segment[window.low] != track.segment[k] && window.low < k) ++window.low;
  while (track.segment[window.high] != track.segment[k] && window.high > k + 1) --window.high;
  return window;
}

void fill_speeds(StepContext& c, const wheels::WheelTrack& track, Window window, double centre,
                 const wheels::BaseParameters& base) {
  const auto left = local_derivatives(track.t, track.left, window.low, window.high, centre);
  const auto right = local_derivatives(track.t, track.right, window.low, window.high, centre);
  c.left_speed = base.left_radius * left.first;
  c.right_speed = base.right_radius * right.first;
  c.left_acceleration = base.left_radius * left.second;
  c.right_acceleration = base.right_radius * right.second;
  c.speed = (c.left_speed + c.right_speed) / 2.0;
  c.turn_rate = (c.right_speed - c.left_speed) / base.track_width;
}

/// Fine encoders show an acceleration over a shorter time than coarse ones.
double duration_for(const wheels::WheelTrack& track, const wheels::BaseParameters& base, double if_fine) {
  const double tick = track.tick_angle * std::max(base.left_radius, base.right_radius);
  return tick <= settings::kCoarse_m ? if_fine : settings::kSmoothing_s;
}

/// A running drive looks at its last intervals: they stay off the heap.
constexpr std::size_t kFewIntervals = 4;

/// Angular accelerations of the wheels, rad/s^2, over the time up to each interval's end from `first` on.
// NOLINTNEXTLINE(bugprone-exception-escape): moving more than a few of them takes memory
struct WheelAccelerations {
  boost::container::small_vector<double, kFewIntervals> left, right;
};
WheelAccelerations latest_accelerations(const wheels::WheelTrack& track, std::size_t first, double duration) {
  WheelAccelerations all;
  std::size_t low = 0;
  for (std::size_t k = first; k + 1 < track.t.size(); ++k) {
    const double from = track.t[k + 1] - duration;
    while (track.segment[low] != track.segment[k + 1] ||
           (low + settings::kCurvatureIntervals < k + 1 && track.t[low + 1] <= from))
      ++low;
    const double centre = (track.t[low] + track.t[k + 1]) / 2.0;
    all.left.push_back(local_derivatives(track.t, track.left, low, k + 1, centre).second);
    all.right.push_back(local_derivatives(track.t, track.right, low, k + 1, centre).second);
  }
  return all;
}

/// The same over the time about the middle of each interval.
WheelAccelerations centred_accelerations(const wheels::WheelTrack& track, std::size_t first,
                                         double duration) {
  WheelAccelerations all;
  Window window;
  for (std::size_t k = first; k + 1 < track.t.size(); ++k) {
    const double centre = (track.t[k] + track.t[k + 1]) / 2.0;
    window = window_around(track, k, window, centre, duration);
    const bool joined = track.segment[k] == track.segment[k + 1];
    const auto curvature = [&](const std::vector<double>& angles) {
      return joined ? local_derivatives(track.t, angles, window.low, window.high, centre).second : 0.0;
    };
    all.left.push_back(curvature(track.left));
    all.right.push_back(curvature(track.right));
  }
  return all;
}

/// From the smoothed accelerations in the middles of the intervals beside it.
void fill_changes_of_acceleration(std::vector<StepContext>& contexts) {
  for (std::size_t k = 0; k < contexts.size(); ++k) {
    const StepContext& before = contexts[k > 0 ? k - 1 : k];
    const StepContext& after = contexts[k + 1 < contexts.size() ? k + 1 : k];
    contexts[k].left_acceleration_change = 0.5 * (after.left_acceleration - before.left_acceleration);
    contexts[k].right_acceleration_change = 0.5 * (after.right_acceleration - before.right_acceleration);
  }
}

/// A robot that slows down ever more gently stands from no certain time on, but passes a slow speed at one; a
/// count or two by which its wheels settle are no motion.
void fill_relative_speeds(std::vector<StepContext>& contexts, const wheels::WheelTrack& track,
                          std::size_t first, const wheels::BaseParameters& base) {
  const double count = track.tick_angle * std::max(base.left_radius, base.right_radius);
  for (std::size_t j = 0; j < contexts.size(); ++j) {
    std::size_t from = first + j;
    const std::size_t to = from + 1;
    while (to - from < settings::kSlowIntervals && from > 0 && track.segment[from - 1] == track.segment[to])
      --from;
    double way = 0.0;
    for (std::size_t k = from; k < to && track.segment[from] == track.segment[to]; ++k)
      way += 0.5 * (base.left_radius * std::abs(track.left[k + 1] - track.left[k]) +
                    base.right_radius * std::abs(track.right[k + 1] - track.right[k]));
    contexts[j].relative_speed =
        way / std::max(settings::kSlow * (track.t[to] - track.t[from]), settings::kFewCounts * count);
  }
}

/// Acceleration may be short, but what lies beyond a threshold must not be noise: the curvature of a parabola
/// through values of deviation s, one every dt over a time T, has the deviation sqrt(720 dt / T^5) s.
double acceleration_window(const wheels::WheelTrack& track, const wheels::BaseParameters& base) {
  const double dt =
      (track.t.back() - track.t.front()) / std::max(1.0, static_cast<double>(track.t.size() - 1));
  const double count = track.tick_angle * std::max(base.left_radius, base.right_radius);
  const double variance = count * count / 12.0 / 2.0;  // of both wheels' mean
  const double wanted =
      std::pow(720.0 * dt * variance / (settings::kAccelerationNoise * settings::kAccelerationNoise), 0.2);
  return std::max(std::clamp(wanted, settings::kShortestAccelerationWindow_s, settings::kSmoothing_s),
                  settings::kCurvatureLeeway * dt);
}

double forward_acceleration(const WheelAccelerations& wheels, std::size_t k,
                            const wheels::BaseParameters& base) {
  return 0.5 * (base.left_radius * wheels.left[k] + base.right_radius * wheels.right[k]);
}

/// Strong acceleration takes effect when it begins, however strong it has to be.
void fill_forward_accelerations(std::vector<StepContext>& contexts, const wheels::WheelTrack& track,
                                std::size_t first, const wheels::BaseParameters& base) {
  const auto wheels = centred_accelerations(track, first, acceleration_window(track, base));
  double peak = 0.0;
  for (std::size_t k = contexts.size(); k-- > 0;) {
    const double acceleration = forward_acceleration(wheels, k, base);
    const bool goes_on =
        std::abs(acceleration) > kAccelerationThresholds.front() && acceleration * peak > 0.0;
    peak = goes_on && std::abs(peak) > std::abs(acceleration) ? peak : acceleration;
    contexts[k].forward_acceleration = acceleration;
    contexts[k].peak_acceleration = peak;
  }
}

/// At the samples between two intervals, from accelerations in their middles that are smoothed no more than a
/// mast with a lag of its own allows.
void fill_accelerations_at_ends(std::vector<StepContext>& contexts, const wheels::WheelTrack& track,
                                std::size_t first, const wheels::BaseParameters& base) {
  const auto wheels = centred_accelerations(track, first, duration_for(track, base, settings::kSharp_s));
  const auto in_middle = [&](std::size_t k) {
    return (base.right_radius * wheels.right[k] - base.left_radius * wheels.left[k]) / base.track_width;
  };
  for (std::size_t k = 0; k < contexts.size(); ++k) {
    const double before = in_middle(k > 0 ? k - 1 : k), own = in_middle(k),
                 after = in_middle(k + 1 < contexts.size() ? k + 1 : k);
    contexts[k].turn_acceleration_before.fill(0.5 * (before + own));
    contexts[k].turn_acceleration_after.fill(0.5 * (own + after));
  }
}

void delay_sways(std::vector<StepContext>& contexts) {
  SwayLag mast;
  for (StepContext& c : contexts) mast.advance(c.turn_acceleration_before, c.turn_acceleration_after, c.dt);
}

/// Those that take more than one interval.
void fill_groups(std::vector<StepContext>& contexts, const wheels::WheelTrack& track, std::size_t first,
                 const wheels::BaseParameters& base, CovariateGroups groups) {
  if (groups.contain(CovariateGroup::sway)) {
    fill_accelerations_at_ends(contexts, track, first, base);
    delay_sways(contexts);
  }
  if (groups.contain(CovariateGroup::acceleration_changes)) fill_changes_of_acceleration(contexts);
  if (groups.contain(CovariateGroup::previous_acceleration))
    fill_forward_accelerations(contexts, track, first, base);
  if (groups.contain(CovariateGroup::stops)) fill_relative_speeds(contexts, track, first, base);
}

}  // namespace

std::vector<StepContext> make_context_of_moment(const wheels::WheelTrack& track,
                                                const wheels::BaseParameters& base, CovariateGroups groups,
                                                std::size_t first) {
  std::vector<StepContext> contexts;
  make_context_of_moment(track, base, groups, first, contexts);
  return contexts;
}

void make_context_of_moment(const wheels::WheelTrack& track, const wheels::BaseParameters& base,
                            CovariateGroups groups, std::size_t first, std::vector<StepContext>& contexts) {
  contexts.clear();
  if (track.empty()) return;
  contexts.reserve(track.t.size() - 1 - first);
  Window window;
  for (std::size_t k = first; k + 1 < track.t.size(); ++k) {
    StepContext& c = contexts.emplace_back();
    const double centre = (track.t[k] + track.t[k + 1]) / 2.0;
    const bool joined = track.segment[k] == track.segment[k + 1];
    c.t = centre - track.t.front();
    c.dt = track.t[k + 1] - track.t[k];
    c.left_angle = (track.left[k] + track.left[k + 1]) / 2.0;
    c.right_angle = (track.right[k] + track.right[k + 1]) / 2.0;
    c.left_delta = joined ? track.left[k + 1] - track.left[k] : 0.0;
    c.right_delta = joined ? track.right[k + 1] - track.right[k] : 0.0;
    window = window_around(track, k, window, centre, settings::kSmoothing_s);
    // Across a change of segment nobody knows how the wheels turned.
    if (joined) fill_speeds(c, track, window, centre, base);
  }
  fill_groups(contexts, track, first, base, groups);
}

void fill_past_covariates(StepContext& last, const wheels::WheelTrack& track,
                          const wheels::BaseParameters& base, CovariateGroups groups) {
  const std::size_t n = track.t.size(), first = n - std::min<std::size_t>(n, 3);
  if (groups.contain(CovariateGroup::acceleration_changes)) {
    const auto wheels =
        latest_accelerations(track, first, duration_for(track, base, settings::kSharpLatest_s));
    last.left_acceleration_change = base.left_radius * (wheels.left.back() - wheels.left.front());
    last.right_acceleration_change = base.right_radius * (wheels.right.back() - wheels.right.front());
  }
  if (groups.contain(CovariateGroup::previous_acceleration)) {
    const auto wheels = latest_accelerations(track, first, acceleration_window(track, base));
    last.forward_acceleration = last.peak_acceleration =
        forward_acceleration(wheels, wheels.left.size() - 1, base);
  }
}

DriveContext make_context(const wheels::WheelTrack& track, const wheels::BaseParameters& base,
                          CovariateGroups groups) {
  std::vector<StepContext> contexts = make_context_of_moment(track, base, groups);
  DriveHistory history(base, track.tick_angle,
                       groups.without({CovariateGroup::gear_play, CovariateGroup::caster}));
  for (StepContext& c : contexts) history.advance(c);
  auto on_demand = std::make_shared<const DriveOnDemand>(contexts, base, dither_of(track.tick_angle), groups);
  return {std::move(contexts), std::move(on_demand)};
}

}  // namespace odomcalib::calib::vehicle
