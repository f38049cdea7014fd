// The parts that are always there, whatever the robot does.
#pragma once

#include <memory>
#include <string>

#include "daemon/safety/lease.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/loop_watch.hpp"
#include "daemon/service/motion_count.hpp"
#include "daemon/service/parts/applied_calibration.hpp"
#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/last_run.hpp"
#include "daemon/service/parts/outbox.hpp"
#include "daemon/service/parts/surroundings.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/state_folder.hpp"
#include "daemon/service/urgency.hpp"

namespace odomcalib {

/// Parts that were opened when the daemon began.
struct Opened {
  BaseLink base;
  LidarLink lidar;
  ControlServer server;
  StateFolder folder;
  Journal journal;
  Urgency urgency;
};

struct RobotParts {
  RobotParts(const Config& configuration, Clock& time, Calibrator functions, Opened opened,
             std::unique_ptr<Background> disk_worker, EventLog log);
  RobotParts(const RobotParts&) = delete;
  RobotParts& operator=(const RobotParts&) = delete;
  ~RobotParts() { disk->finish(); }  // while everything is there that its work may use

  Config config;
  Clock& clock;
  Calibrator calibrator;
  double now = 0.0;  ///< s, begin of this turn
  LoopWatch loop;
  StateFolder folder;
  Urgency urgency;
  std::unique_ptr<Background> disk;  ///< waits for the disk

  Outbox outbox;
  Drive drive;
  Surroundings surroundings;
  DeadReckoning odometry;
  MotionCount recorded;  ///< of the recording in progress, or of the last one
  AppliedCalibration applied;
  WriteBack write_back;
  safety::Lease lease;

  LastRun last_run;
  bool ending = false;  ///< the daemon ends
};

/// Zero speed and quick stop, on the bus when it returns.
void stop_drive(Drive& drive, const WriteBack& write_back, double now);

}  // namespace odomcalib
