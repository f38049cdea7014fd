// How urgent the loop is for the machine, and whether its memory stays where it is: a drive that waits for a
// sign of life does not know that other programs are busy.
#pragma once

#include <string>

namespace odomcalib {

struct Urgency {
  std::string found;   ///< for people; empty: nobody has looked
  std::string remedy;  ///< empty: nothing is missing
};

/// Gives the thread that calls this a real-time priority where it has none and may have one (unit:
/// LimitRTPRIO), keeps its threads and processes from being as urgent, and what this process has in its
/// memory there: once, before there are others.
Urgency made_urgent();

/// This process is not urgent, whatever it was started by: the solver.
void step_back();

}  // namespace odomcalib
