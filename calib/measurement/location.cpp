#include "calib/measurement/location.hpp"

namespace odomcalib::calib::measurement {
namespace {

void count_from_first(std::vector<vehicle::Fix>& fixes) {
  if (fixes.empty()) return;
  const math::Pose first = fixes.front().pose;
  for (vehicle::Fix& fix : fixes) fix.pose = between(first, fix.pose);
}

}  // namespace

std::vector<vehicle::Fix> fixes_of(const ScanPath& path, const math::Pose& mount) {
  std::vector<vehicle::Fix> fixes;
  for (const PlacedScan& scan : path.scans) fixes.push_back({scan.time, compose(scan.pose, inverse(mount))});
  count_from_first(fixes);
  return fixes;
}

std::vector<vehicle::Fix> fixes_of(const Recording& recording) {
  std::vector<vehicle::Fix> fixes;
  for (const PoseSample& sample : recording.poses)
    fixes.push_back({sample.t, {sample.x, sample.y, sample.yaw}});
  count_from_first(fixes);
  return fixes;
}

}  // namespace odomcalib::calib::measurement
