// What the service makes of the end of a write-back: committed, rolled back or unknown.
#pragma once

#include "daemon/service/parts/bench.hpp"

namespace odomcalib {

/// Takes over what the controller holds now; a write-back goes into the history too, is reported to clients,
/// brings its calibration into force where it was committed, and forbids motion where it ended unknown
/// (WriteBack::operator_needed).
void settle_write(Bench& bench, const WriteReport& report);

/// Puts the calibration of this id in force; see CalibrationInForce::settle.
/// @return why the host goes on with the former calibration although the controller has the values of this
/// one
std::optional<Error> settle_calibration(Bench& bench, const std::string& id);

}  // namespace odomcalib
