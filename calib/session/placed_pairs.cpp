#include "calib/session/placed_pairs.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/geometry/vector2.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kSameTime = 1e-6;  // s

/// Where a pair's scans were taken, if both are known.
std::optional<std::pair<PlacedScan, PlacedScan>> places_of(const SensorPair& pair, const ScanPath& path,
                                                           const PathOfWheels& wheels) {
  const auto begin = place_at(path.scans, pair.interval.begin, wheels);
  const auto end = place_at(path.scans, pair.interval.end, wheels);
  return begin && end ? std::optional(std::pair(*begin, *end)) : std::nullopt;
}

}  // namespace

double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path,
                        const PathOfWheels& wheels) {
  Eigen::Vector3d drift = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (const SensorPair& pair : pairs) {
    const auto places = places_of(pair, path, wheels);
    if (!places) continue;
    const Eigen::Matrix3d into_map = rotation_about_z(places->first.pose.yaw);
    drift += into_map * difference(pair.motion, between(places->first.pose, places->second.pose));
    variance += (into_map * pair.covariance * into_map.transpose()).diagonal();
  }
  if (!(variance.minCoeff() > 0.0)) return 0.0;
  return drift.cwiseQuotient(variance.cwiseSqrt()).cwiseAbs().maxCoeff();
}

std::vector<SensorPair> pairs_of_places(const std::vector<SensorPair>& pairs, const ScanPath& path,
                                        const PathOfWheels& wheels) {
  std::vector<SensorPair> out;
  double last_end = -1e300;
  for (const SensorPair& pair : pairs) {
    const auto places = places_of(pair, path, wheels);
    if (!places) continue;
    const auto [motion, covariance] = motion_between(places->first, places->second);
    const bool follows = std::abs(pair.interval.begin - last_end) < kSameTime;
    out.push_back({pair.interval, motion, covariance, follows});
    last_end = pair.interval.end;
  }
  return out;
}

}  // namespace odomcalib::calib
