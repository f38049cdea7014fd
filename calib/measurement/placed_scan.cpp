#include "calib/measurement/placed_scan.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace odomcalib::calib::measurement
