#include "calib/measurement/placed_scan.hpp"

#include <algorithm>
#include <cmath>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

using PlaceIterator = std::span<const PlacedScan>::iterator;

PlaceIterator first_since(std::span<const PlacedScan> places, double time) {
  return std::lower_bound(places.begin(), places.end(), time,
                          [](const PlacedScan& scan, double t) { return scan.time < t; });
}

PlacedScan carried(const PlacedScan& scan, double time, const PathOfWheels& wheels) {
  return {time, compose(scan.pose, between(wheels(scan.time), wheels(time))), scan.covariance};
}

math::Pose wrapped_pose_of(const PoseSample& sample) {
  return {sample.x, sample.y, math::wrap_angle(sample.yaw)};
}

/// Differences between each motion from one pose to the next and that of the wheels; the step over a gap is
/// left out.
std::vector<Eigen::Vector3d> steps_beyond_wheels(std::span<const PoseSample> poses,
                                                 const PathOfWheels& wheels) {
  std::vector<Eigen::Vector3d> steps;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (poses[k].t - poses[k - 1].t > ingest::settings::kMaxGap_s) continue;
    steps.push_back(math::difference(between(wrapped_pose_of(poses[k - 1]), wrapped_pose_of(poses[k])),
                                     between(wheels(poses[k - 1].t), wheels(poses[k].t))));
  }
  return steps;
}

/// Noise of a single pose, x, y, yaw. The middle one of three poses shows it, whatever scale the wheels have:
/// the second difference has six times the variance of one.
Eigen::Vector3d noise_of(std::span<const PoseSample> poses, const PathOfWheels& wheels) {
  const std::vector<Eigen::Vector3d> steps = steps_beyond_wheels(poses, wheels);
  if (steps.size() < 3) return Eigen::Vector3d::Constant(settings::kUnknownPoseNoise);
  Eigen::Vector3d noise;
  for (Eigen::Index i = 0; i < noise.size(); ++i) {
    std::vector<double> sizes;
    for (std::size_t k = 1; k < steps.size(); ++k) sizes.push_back(std::abs(steps[k](i) - steps[k - 1](i)));
    noise(i) = std::max(math::kMadToSigma * math::median_of(std::move(sizes)) / std::sqrt(6.0),
                        settings::kLeastPoseNoise);
  }
  const double position = std::sqrt(0.5 * (noise(0) * noise(0) + noise(1) * noise(1)));
  return {position, position, noise(2)};
}

/// Each by itself; headings go on beyond half a turn.
std::vector<PlacedScan> single_places(std::span<const PoseSample> poses, const Eigen::Vector3d& noise) {
  std::vector<PlacedScan> places;
  places.reserve(poses.size());
  for (const PoseSample& sample : poses) {
    math::Pose pose = wrapped_pose_of(sample);
    if (!places.empty()) {
      const double before = places.back().pose.yaw;
      pose.yaw = before + math::wrap_angle(pose.yaw - before);
    }
    places.push_back({sample.t, pose, noise.cwiseAbs2().asDiagonal()});
  }
  return places;
}

double mean_time(std::span<const PlacedScan> places) {
  double sum = 0.0;
  for (const PlacedScan& place : places) sum += place.time;
  return sum / static_cast<double>(places.size());
}

}  // namespace

PlacedMotion motion_between(const PlacedScan& begin, const PlacedScan& end) {
  PlacedMotion out{between(begin.pose, end.pose), {}};
  const Eigen::Matrix3d into_begin = math::rotation_about_z(-begin.pose.yaw);
  Eigen::Matrix3d by_begin = -into_begin;
  by_begin(0, 2) = out.motion.y;
  by_begin(1, 2) = -out.motion.x;
  out.covariance = by_begin * begin.covariance * by_begin.transpose() +
                   into_begin * end.covariance * into_begin.transpose();
  return out;
}

PathOfWheels path_of_wheels(const vehicle::Trajectory& trajectory) {
  return [&trajectory, mount = vehicle::to_base(trajectory.parameters()).mount](double time) {
    return compose(trajectory.at(time), mount);
  };
}

std::optional<PlacedScan> place_at(std::span<const PlacedScan> places, double time,
                                   const PathOfWheels& wheels) {
  const auto nearest = std::min_element(
      first_since(places, time - settings::kPlaceReach_s),
      first_since(places, time + settings::kPlaceReach_s),
      [&](const auto& a, const auto& b) { return std::abs(a.time - time) < std::abs(b.time - time); });
  if (nearest == places.end() || std::abs(nearest->time - time) > settings::kPlaceReach_s)
    return std::nullopt;
  return carried(*nearest, time, wheels);
}

std::optional<PlacedEnds> places_at_ends(std::span<const PlacedScan> places,
                                         const vehicle::Interval& interval, const PathOfWheels& wheels) {
  const auto begin = place_at(places, interval.begin, wheels), end = place_at(places, interval.end, wheels);
  return begin && end ? std::optional(PlacedEnds{*begin, *end}) : std::nullopt;
}

PlacedScan mean_of(std::span<const PlacedScan> places, double time, const PathOfWheels& wheels) {
  const auto count = static_cast<double>(places.size());
  const double yaw = places.front().pose.yaw;
  PlacedScan mean{time, {0.0, 0.0, yaw}, Eigen::Matrix3d::Zero()};
  for (const PlacedScan& place : places) {
    const PlacedScan one = carried(place, time, wheels);
    mean.pose.x += one.pose.x / count;
    mean.pose.y += one.pose.y / count;
    mean.pose.yaw += math::wrap_angle(one.pose.yaw - yaw) / count;
    mean.covariance += one.covariance / (count * count);
  }
  return mean;
}

std::optional<PlacedScan> mean_place(std::span<const PlacedScan> places, double time,
                                     const PathOfWheels& wheels, double reach) {
  const PlaceIterator first = first_since(places, time - reach), last = first_since(places, time + reach);
  if (last - first < settings::kFewestOfMean) return std::nullopt;
  return mean_of({first, last}, time, wheels);
}

std::vector<PlacedScan> placed_poses(std::span<const PoseSample> poses, const PathOfWheels& wheels) {
  const std::vector<PlacedScan> singles = single_places(poses, noise_of(poses, wheels));
  std::vector<PlacedScan> places;
  for (std::size_t first = 0; first < singles.size();) {
    std::size_t end = first + 1;
    while (end < singles.size() && singles[end].time - singles[first].time < settings::kWheelSpan_s) ++end;
    const auto span = std::span(singles).subspan(first, end - first);
    places.push_back(mean_of(span, mean_time(span), wheels));
    first = end;
  }
  return places;
}

}  // namespace odomcalib::calib::measurement
