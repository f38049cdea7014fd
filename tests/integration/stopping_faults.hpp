// Faults in mid-motion that must end it.
#pragma once

#include <ostream>
#include <span>

#include "tests/sim/wires/sim_robot.hpp"

namespace odomcalib {

struct Fault {
  const char* name;
  void (*begin)(sim::SimRobot& robot);
  void (*end)(sim::SimRobot& robot);
  const char* said;                ///< part of the reason that is reported
  double limit;                    ///< s until the drive is no longer told to turn
  double ready = 5.0;              ///< s after the fault has gone until the robot may be started again
  const char* state = "disabled";  ///< of the controller then
};

inline std::ostream& operator<<(std::ostream& out, const Fault& fault) { return out << fault.name; }

std::span<const Fault> stopping_faults();

}  // namespace odomcalib
