#include "calib/session/location.hpp"

namespace odomcalib::calib {
namespace {

void count_from_first(std::vector<Fix>& fixes) {
  if (fixes.empty()) return;
  const Pose first = fixes.front().pose;
  for (Fix& fix : fixes) fix.pose = between(first, fix.pose);
}

}  // namespace

std::vector<Fix> fixes_of(const ScanPath& path, const Pose& mount) {
  std::vector<Fix> fixes;
  for (const PlacedScan& scan : path.scans) fixes.push_back({scan.time, compose(scan.pose, inverse(mount))});
  count_from_first(fixes);
  return fixes;
}

std::vector<Fix> fixes_of(const Recording& recording) {
  std::vector<Fix> fixes;
  for (const PoseSample& sample : recording.poses)
    fixes.push_back({sample.t, {sample.x, sample.y, sample.yaw}});
  count_from_first(fixes);
  return fixes;
}

}  // namespace odomcalib::calib
