// The sources that `export` fills with the values of a calibration (daemon/cli/export/), as they were when
// the program was built.
#pragma once

namespace odomcalib::cli {

extern const char* const kStepInC;
extern const char* const kStepInPython;

}  // namespace odomcalib::cli
