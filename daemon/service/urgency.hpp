// How urgent the loop is for the machine, and whether its memory stays where it is: a drive that waits for a
// sign of life does not know that other programs are busy.
#pragma once

#include <string>

namespace odomcalib {

struct Urgency {
  std::string found;   ///< for people; empty: nobody has looked
  std::string remedy;  ///< empty: nothing is missing
};

/// Keeps what this process has in its memory there, and its threads and processes from being as urgent as the
/// thread that calls this: once, before there are others. The priority itself comes from whoever starts the
/// program (unit: CPUSchedulingPolicy).
Urgency made_urgent();

/// This process is not urgent, whatever it was started by: the solver.
void step_back();

}  // namespace odomcalib
