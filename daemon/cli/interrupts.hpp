// Ctrl-C where nothing moves: the program ends as cancelled, and has written nothing.
#pragma once

#include "daemon/cli/output.hpp"

namespace odomcalib::cli {

/// Until a verb catches them itself, SIGINT, SIGTERM and SIGHUP end the program with the status of
/// cancellation. What the parent lets this program ignore stays ignored.
void end_when_interrupted(JsonMode json);

}  // namespace odomcalib::cli
