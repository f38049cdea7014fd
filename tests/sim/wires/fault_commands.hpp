// Faults by name, one line each, so that a script can spoil a running simulation.
#pragma once

#include <string>

#include "proto/result.hpp"
#include "tests/sim/wires/sim_robot.hpp"

namespace odomcalib::sim {

/// Carries out one line:
///   cut can|lidar, restore can|lidar           cable behind the port
///   unplug can|lidar, plug can|lidar           the port itself
///   freeze pdo|lidar, thaw pdo|lidar           the same content over and over
///   silence heartbeat|sdo|pdo, speak ...       one service of the drive
///   reset drive|lidar                          power cycle
///   emcy CODE                                  emergency message and fault, hexadecimal code
///   abort INDEX SUB CODE                       SDO writes of this object are refused, all hexadecimal
///   jump LEFT RIGHT                            counts added to the counters
///   hold left|right, release left|right        encoder stands still
///   obstacle X Y                               pillar of 0.1 m radius at this place in the room
///   clear                                      all planned SDO aborts are forgotten
/// Error usage: unknown line.
Result<void> apply_command(SimRobot& robot, const std::string& line);

}  // namespace odomcalib::sim
