// What the lidar shows: its line, whether scans are fresh, what stands in the way and what it cannot see.
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/safety/cover.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/service/lidar_link.hpp"

namespace odomcalib {

class Surroundings {
 public:
  /// @param config outlives this
  Surroundings(LidarLink lidar_link, const Config& config);

  /// Whole turns that have come.
  std::vector<Scan> serve(const Clock& clock);
  /// Judges one of them. @param twist of the robot now: where it goes is looked at for obstacles
  void judge(const Scan& scan, const routines::Twist& twist, double now);

  LidarLink link;
  safety::ScanFreshness scans;
  safety::ObstacleGuard obstacles;
  safety::Cover cover;
  std::vector<safety::Point> points;  ///< of the newest scan, base frame
  std::uint64_t scan_count = 0;

 private:
  const Config& config_;
};

}  // namespace odomcalib
