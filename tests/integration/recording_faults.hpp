// A sound drive told in each form that a recording may have, and faults put into it.
#pragma once

#include <map>
#include <string>

#include "calib/ingest/form.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::recording_faults {

using calib::ingest::Form;

/// The drive as a sound recording that has the form, without whatever a simulator says of it; times are
/// dates.
Recording told_as(const sim::SimulatedRun& drive, Form form);

/// How much of a fault, from nearly nothing (0) to plain (1), and from when on, as a share of the drive.
struct Draw {
  double size = 1.0;
  double moment = 0.5;
};

using Make = void (*)(Recording& recording, Form form, const Draw& draw);

/// Functions that put the fault of that name into a recording that has the form: one for each row of
/// calib::ingest::faults().
const std::map<std::string, Make>& makers();

}  // namespace odomcalib::recording_faults
