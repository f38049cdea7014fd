// Ctrl-C where nothing moves.
#pragma once

#include "daemon/cli/output.hpp"

namespace odomcalib::cli {

/// Until a verb catches them itself, SIGINT, SIGTERM and SIGHUP end the program with the status of
/// cancellation, and nothing is written. What the parent lets this program ignore stays ignored.
void end_when_interrupted(JsonMode json);

/// From now on these signals end nothing by themselves: a verb that runs until then asks, and ends as done.
void finish_when_interrupted();
bool interrupted();

}  // namespace odomcalib::cli
