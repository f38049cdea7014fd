#include "calib/measurement/placed_pairs.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/math/vector2.hpp"

namespace odomcalib::calib::measurement {
namespace {

constexpr double kSameTime = 1e-6;  // s

}  // namespace

double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path,
                        const PathOfWheels& wheels) {
  Eigen::Vector3d drift = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (const SensorPair& pair : pairs) {
    const auto ends = places_at_ends(path.scans, pair.interval, wheels);
    if (!ends) continue;
    const Eigen::Matrix3d into_map = math::rotation_about_z(ends->begin.pose.yaw);
    drift += into_map * math::difference(pair.motion, between(ends->begin.pose, ends->end.pose));
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
    const auto ends = places_at_ends(path.scans, pair.interval, wheels);
    if (!ends) continue;
    const auto [motion, covariance] = motion_between(ends->begin, ends->end);
    const bool follows = std::abs(pair.interval.begin - last_end) < kSameTime;
    out.push_back({pair.interval, motion, covariance, follows});
    last_end = pair.interval.end;
  }
  return out;
}

}  // namespace odomcalib::calib::measurement
