#include "calib/measurement/scan_stamps.hpp"

#include <algorithm>
#include <vector>

#include "calib/ingest/even_stamps.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// The same intervals with each end moved as the scan's stamp was.
std::vector<vehicle::Interval> moving_intervals(const std::vector<SensorPair>& pairs,
                                                const std::vector<double>& given,
                                                const std::vector<double>& even) {
  const auto moved_time = [&](double time) {
    const auto after = std::upper_bound(given.begin(), given.end(), time) - given.begin();
    const auto scan = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
    return time + even[scan] - given[scan];
  };
  std::vector<vehicle::Interval> intervals;
  intervals.reserve(pairs.size());
  for (const SensorPair& pair : pairs)
    intervals.push_back({moved_time(pair.interval.begin), moved_time(pair.interval.end)});
  return intervals;
}

/// In deviations of the match.
Eigen::Vector3d error_of(const SensorPair& pair, const math::Pose& predicted) {
  const Eigen::Vector3d error(pair.motion.x - predicted.x, pair.motion.y - predicted.y,
                              math::wrap_angle(pair.motion.yaw - predicted.yaw));
  return error.array() / pair.covariance.diagonal().array().sqrt();
}

}  // namespace

std::optional<ingest::EvenStamps> even_scans(const Recording& recording, const FitData& data,
                                             const vehicle::EffectList& effects,
                                             const Eigen::VectorXd& parameters) {
  const std::vector<double> given = stamps_of(recording.scans);
  auto even = ingest::even_stamps(given);
  if (!even) return std::nullopt;
  std::vector<vehicle::Interval> intervals;
  intervals.reserve(data.pairs.size());
  for (const SensorPair& pair : data.pairs) intervals.push_back(pair.interval);
  const vehicle::Trajectory odometry = data.model->trajectory(vehicle::as_span(parameters), effects);
  const auto by_given = odometry.sensor_motions(intervals);
  const auto by_even = odometry.sensor_motions(moving_intervals(data.pairs, given, even->t));
  ingest::StampComparison contest;
  for (std::size_t k = 0; k < data.pairs.size(); ++k) {
    const Eigen::Vector3d a = error_of(data.pairs[k], by_given[k]), b = error_of(data.pairs[k], by_even[k]);
    for (Eigen::Index c = 0; c < 3; ++c) contest.add(a(c), b(c));
  }
  return contest.even_is_better() ? even : std::nullopt;
}

}  // namespace odomcalib::calib::measurement
