// Recordings without wires: the same robot and room, straight into the value types of a recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/recording/recording.hpp"
#include "tests/sim/world/body.hpp"
#include "tests/sim/world/drives.hpp"
#include "tests/sim/world/lidar_head.hpp"

namespace odomcalib::sim {

struct SimulationConfig {
  Geometry nominal;  ///< what the robot line of the recording says
  Geometry truth;    ///< what the robot is
  Room room;
  double duration = 240.0;      ///< s
  double tick_period = 0.02;    ///< s; also the period of the drive
  bool name_lidar_pose = true;  ///< write the nominal lidar pose into the recording
  BodyOptions body;
  LidarOptions lidar;
  Disturbances disturbances;
  std::uint64_t seed = 1;      ///< of every noise
  double truth_period = 0.02;  ///< s, of `path`
};

/// True pose of the base at a time (also before each tick sample).
struct TruthSample {
  double t = 0.0;
  Pose pose;
  PerSide rate{};
};

struct SimulatedRun {
  Recording recording;
  Geometry truth;
  std::vector<TruthSample> path;
  std::vector<double> tick_times;  ///< s, when each tick sample of the recording was really taken
  std::vector<double> scan_times;  ///< s, when the first beam of each scan was really sent
  double least_clearance =
      0.0;  ///< m from the base to the nearest wall on the way; below 0.2 the run is no good
};

/// Deterministic: same configuration and drive, same run.
SimulatedRun simulate_recording(const SimulationConfig& config, const Drive& drive);

/// A ready-made good run: robot and noise drawn from the seed, furnished room, guided pattern (about five
/// minutes).
SimulationConfig standard_config(std::uint64_t seed);
SimulatedRun standard_run(std::uint64_t seed);

}  // namespace odomcalib::sim
