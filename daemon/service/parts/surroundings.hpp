// View of the lidar: its line, whether scans are fresh, what stands in the way and what it cannot see.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/safety/braking.hpp"
#include "daemon/safety/cover.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/service/lidar_link.hpp"
#include "daemon/service/parts/link_watch.hpp"

namespace odomcalib {

class Surroundings {
 public:
  /// @param config outlives this
  Surroundings(LidarLink lidar_link, const Config& config);

  /// Whole turns that have come.
  std::vector<Scan> serve(const Clock& clock);
  /// News about the line to the lidar, since the last call.
  std::optional<LinkWatch::News> take_news() {
    return watch_.look(link.device(), link.connected(), link.problem());
  }
  /// Judges one of them. @param twist of the robot now: where it goes is looked at for obstacles
  void judge(const Scan& scan, const routines::Twist& twist, double now);

  LidarLink link;
  safety::ScanFreshness scans;
  safety::ObstacleGuard obstacles;
  safety::Braking braking;
  safety::Cover cover;
  std::vector<safety::Point> points;  ///< of the newest scan, base frame
  std::uint64_t scan_count = 0;

 private:
  LinkWatch watch_;
  const Config& config_;
};

}  // namespace odomcalib
