#include "daemon/service/parts/surroundings.hpp"

namespace odomcalib {

Surroundings::Surroundings(LidarLink lidar_link, const Config& config)
    : link(std::move(lidar_link)),
      obstacles({.footprint = config.footprint, .acceleration = config.limits.acceleration}),
      config_(config) {}

std::vector<Scan> Surroundings::serve(const Clock& clock) {
  link.step(clock);
  return link.take_scans();
}

void Surroundings::judge(const Scan& scan, const routines::Twist& twist, double now) {
  ++scan_count;
  scans.seen(scan, now);
  cover.seen(scan, config_.lidar_pose, config_.footprint, now);
  obstacles.turned(scan.t);
  obstacles.brakes(braking.overrun());
  points = safety::points_of(scan, config_.lidar_pose);
  obstacles.seen(points, twist);
}

}  // namespace odomcalib
