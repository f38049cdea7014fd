#include "calib/session/placed_pairs.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/geometry/vector2.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kSameTime = 1e-6;  // s

const PlacedScan* place_at(const ScanPath& path, double time) {
  const auto found = std::lower_bound(path.scans.begin(), path.scans.end(), time - kSameTime,
                                      [](const PlacedScan& scan, double t) { return scan.time < t; });
  return found != path.scans.end() && found->time < time + kSameTime ? &*found : nullptr;
}

/// The places of a pair's scans, where both have one.
struct Places {
  const PlacedScan* begin = nullptr;
  const PlacedScan* end = nullptr;
};
std::optional<Places> places_of(const SensorPair& pair, const ScanPath& path) {
  const Places places{place_at(path, pair.interval.begin), place_at(path, pair.interval.end)};
  return places.begin != nullptr && places.end != nullptr ? std::optional(places) : std::nullopt;
}

/// First order; the two places err independently.
Eigen::Matrix3d covariance_of(const PlacedScan& begin, const PlacedScan& end, const Pose& motion) {
  const Eigen::Matrix3d into_begin = rotation_about_z(-begin.pose.yaw);
  Eigen::Matrix3d by_begin = -into_begin;
  by_begin(0, 2) = motion.y;
  by_begin(1, 2) = -motion.x;
  return by_begin * begin.covariance * by_begin.transpose() +
         into_begin * end.covariance * into_begin.transpose();
}

}  // namespace

double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path) {
  Eigen::Vector3d drift = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (const SensorPair& pair : pairs) {
    const auto places = places_of(pair, path);
    if (!places) continue;
    const Pose placed = between(places->begin->pose, places->end->pose);
    const Eigen::Matrix3d into_map = rotation_about_z(places->begin->pose.yaw);
    drift += into_map * difference(pair.motion, placed);
    variance += (into_map * pair.covariance * into_map.transpose()).diagonal();
  }
  if (!(variance.minCoeff() > 0.0)) return 0.0;
  return drift.cwiseQuotient(variance.cwiseSqrt()).cwiseAbs().maxCoeff();
}

std::vector<SensorPair> pairs_of_places(const std::vector<SensorPair>& pairs, const ScanPath& path) {
  std::vector<SensorPair> out;
  double last_end = -1e300;
  for (const SensorPair& pair : pairs) {
    const auto places = places_of(pair, path);
    if (!places) continue;
    const Pose motion = between(places->begin->pose, places->end->pose);
    const bool follows = std::abs(pair.interval.begin - last_end) < kSameTime;
    out.push_back({pair.interval, motion, covariance_of(*places->begin, *places->end, motion), follows});
    last_end = pair.interval.end;
  }
  return out;
}

}  // namespace odomcalib::calib
