#include "calib/ingest/reference_scale.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "calib/ingest/settings.hpp"

namespace odomcalib::calib::ingest {
namespace {

void multiply(Recording& recording, double scale) {
  for (Scan& scan : recording.scans) {
    for (float& range : scan.ranges) range = static_cast<float>(scale * static_cast<double>(range));
    scan.range_min *= scale;
    scan.range_max *= scale;
  }
  for (PoseSample& pose : recording.poses) {
    pose.x *= scale;
    pose.y *= scale;
  }
  for (IncrementSample& increment : recording.increments) {
    increment.lidar_motion[0] *= scale;
    increment.lidar_motion[1] *= scale;
  }
}

}  // namespace

std::optional<Scale> scale_by_data_sheet(std::span<const Recording> recordings) {
  const auto is_by_scans = [](const Recording& recording) {
    return recording.poses.empty() && recording.increments.empty() && !recording.scans.empty();
  };
  if (!std::any_of(recordings.begin(), recordings.end(), is_by_scans)) return std::nullopt;
  return Scale{1.0, settings::kLidarScale, "lidar data sheet"};
}

Recordings with_scale(std::span<const Recording> given, double scale) {
  if (scale == 1.0) return Recordings(given);
  std::vector<Recording> scaled(given.begin(), given.end());
  for (Recording& recording : scaled) multiply(recording, scale);
  return {std::move(scaled), {}};
}

}  // namespace odomcalib::calib::ingest
